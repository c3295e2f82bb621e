#include <fmt/format.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/printable.h"
#include "pipeline/store/h5_detail.h"

namespace npdr::pipeline::h5 {
namespace {

// Nothing that deflate or a fill value can make of a file is larger than this many times its size.
constexpr std::uint64_t kMaxCompression = 1100;
// Claims below this are cheap to believe.
constexpr std::uint64_t kTrustedBytes = 64 << 20;

Handle type_of(const Object& dataset) {
  return opened(H5Dget_type(dataset.id()), dataset.where(), "be opened");
}

// The first filter of a dataset that this HDF5 lacks, such as h5py's lzf; "": it has them all.
std::string missing_filter(const Object& dataset) {
  const Handle settings = properties_of(dataset);
  const int count = H5Pget_nfilters(settings.id());
  for (int i = 0; i < count; ++i) {
    std::array<char, 64> name = {};
    std::size_t num_values = 0;
    unsigned flags = 0, config = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(settings.id(), static_cast<unsigned>(i), &flags, &num_values, nullptr,
                       name.size() - 1, name.data(), &config);
    if (filter >= 0 && H5Zfilter_avail(filter) == 0) {
      return name[0] == '\0' ? std::to_string(filter) : printable_line(name.data());
    }
  }
  return "";
}

Handle space_of(const Object& dataset) {
  return opened(H5Dget_space(dataset.id()), dataset.where(), "be opened");
}

// Raw bytes of any other file, wherever who made this one said that they are.
void require_own_bytes(const Object& dataset) {
  if (H5Pget_external_count(properties_of(dataset).id()) == 0) return;
  throw InputError(dataset.where() + ": its values are bytes of other files, must be in this one");
}

// The shape, before which nothing of a dataset is looked at.
Shape checked_shape(const Object& dataset) {
  require_own_bytes(dataset);
  if (is_virtual(dataset)) check_mapping(dataset);
  return shape_of(space_of(dataset).id(), dataset.where());
}

// Row-major position of element `i`.
Shape position(const Shape& shape, Index i) {
  Shape result(shape.size());
  for (std::size_t d = shape.size(); d-- > 0;) {
    result[d] = i % shape[d];
    i /= shape[d];
  }
  return result;
}

}  // namespace

Dataset::Dataset(Handle handle, std::string where)
    : Object(std::move(handle), std::move(where)), shape_(checked_shape(*this)) {}

Index Dataset::row_size() const {
  return shape_.empty() ? 1 : size_of(Shape(shape_.begin() + 1, shape_.end()));
}

ElementType Dataset::type() const { return our_type(type_of(*this).id(), where()); }

void Dataset::require_shape(const Shape& expected) const {
  bool same = shape_.size() == expected.size();
  for (std::size_t d = 0; same && d < expected.size(); ++d) {
    same = expected[d] < 0 || expected[d] == shape_[d];
  }
  if (same) return;
  throw InputError(
      fmt::format("{} has shape {}, must be {}", where(), to_string(shape_), to_string(expected)));
}

void Dataset::label_dimensions(const std::vector<std::string>& labels) {
  if (labels.size() != shape_.size()) {
    throw ShapeError(fmt::format("{} has shape {}: {} labels don't name its dimensions", where(),
                                 to_string(shape_), labels.size()));
  }
  prepare();
  for (unsigned d = 0; d < labels.size(); ++d) {
    written(H5DSset_label(id(), d, labels[d].c_str()), where(), "hold its dimensions' labels");
  }
}

void Dataset::require_readable(ElementType type) const {
  if (readable_as_ == type) return;
  const Handle stored = type_of(*this);
  if (!can_be_read_as(stored.id(), type)) {
    throw InputError(
        fmt::format("{} holds {}, must hold {}", where(), describe(stored.id()), describe(type)));
  }
  if (is_virtual(*this)) {
    parts_ = std::make_shared<VirtualParts>(*this);
  } else {
    require_stored(static_cast<Index>(H5Tget_size(stored.id())));
  }
  readable_as_ = type;
}

void Dataset::require_stored(Index element_size) const {
  const auto claimed = static_cast<std::uint64_t>(size_of(shape_) * element_size);
  H5Dflush(id());  // chunks of a new file that are in memory only don't count
  const std::uint64_t held = H5Dget_storage_size(id());
  if (claimed > 0 && held == 0) {
    throw InputError(fmt::format("{} claims shape {}, but nothing was ever written to it", where(),
                                 to_string(shape_)));
  }
  // Chunks may be compressed; otherwise the file holds every byte of the array.
  const bool is_chunked = H5Pget_layout(properties_of(*this).id()) == H5D_CHUNKED;
  const bool believable =
      is_chunked ? claimed <= kTrustedBytes || claimed / kMaxCompression <= held : claimed <= held;
  if (!believable) {
    throw InputError(
        fmt::format("{} claims shape {} ({} bytes), but the file holds only {} bytes "
                    "of it",
                    where(), to_string(shape_), claimed, held));
  }
}

void Dataset::check_rows(Index begin, Index count, Index num_values) const {
  if (begin < 0 || count < 0 || count > num_rows() - begin) {
    throw ShapeError(fmt::format("{} has {} rows: rows {} to {} don't exist", where(), num_rows(),
                                 begin, begin + count - 1));
  }
  if (num_values != count * row_size()) {
    throw ShapeError(fmt::format("{}: {} rows have {} values, not {}", where(), count,
                                 count * row_size(), num_values));
  }
}

void Dataset::read_raw(ElementType type, Index begin, Index count, void* values) const {
  prepare();
  require_readable(type);
  if (parts_) return read_parts(type, begin, count, values);
  const Handle space = space_of(*this);
  const Handle memory = select_rows(space.id(), shape_, begin, count);
  const Handle element = memory_type(type);
  if (H5Dread(id(), element.id(), memory.id(), space.id(), H5P_DEFAULT, values) < 0) {
    const hid_t why = H5Eget_current_stack();
    const std::string filter = missing_filter(*this);
    H5Eset_current_stack(why);
    if (filter.empty()) fail_reading(where(), "be read");
    throw InputError(where() + ": is compressed by '" + filter +
                     "', which the HDF5 library here can't undo; write it with gzip, or as it is");
  }
}

void Dataset::read_parts(ElementType type, Index begin, Index count, void* values) const {
  const auto row_bytes = row_size() * static_cast<Index>(H5Tget_size(memory_type(type).id()));
  for (Index done = 0; done < count;) {
    const VirtualParts::Piece piece = parts_->from(begin + done);
    const Index num_rows = std::min(count - done, piece.num_rows);
    try {
      piece.part.read_raw(type, piece.begin, num_rows,
                          static_cast<char*>(values) + done * row_bytes);
    } catch (const InputError& error) {
      parts_->fail(piece.file, error);
    }
    done += num_rows;
  }
}

void Dataset::write_raw(ElementType type, Index begin, Index count, const void* values) {
  prepare();
  const Handle space = space_of(*this);
  const Handle memory = select_rows(space.id(), shape_, begin, count);
  const Handle element = memory_type(type);
  written(H5Dwrite(id(), element.id(), memory.id(), space.id(), H5P_DEFAULT, values), where(),
          "be written");
}

std::vector<std::string> Dataset::read_texts() const {
  require_readable(ElementType::text);
  if (parts_) throw InputError(where() + ": texts must be in this file itself");
  const Handle stored = type_of(*this);
  const Handle space = space_of(*this);
  return h5::read_texts(stored.id(), space.id(), size_of(shape_), where(),
                        [&](hid_t memory, void* data) {
                          return H5Dread(id(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data);
                        });
}

void Dataset::write_texts(const std::vector<std::string>& texts) {
  if (static_cast<Index>(texts.size()) != size_of(shape_)) {
    throw ShapeError(fmt::format("{} has shape {}: {} texts don't fill it", where(),
                                 to_string(shape_), texts.size()));
  }
  h5::write_texts(texts, where(), [&](hid_t memory, const void* data) {
    return H5Dwrite(id(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data);
  });
}

template <class T>
void Dataset::require_finite(std::span<const T> values) const {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    throw InputError(fmt::format("{} holds {} at {}, must be finite", where(), values[i],
                                 to_string(position(shape_, static_cast<Index>(i)))));
  }
}

template void Dataset::require_finite(std::span<const float>) const;
template void Dataset::require_finite(std::span<const double>) const;

}  // namespace npdr::pipeline::h5
