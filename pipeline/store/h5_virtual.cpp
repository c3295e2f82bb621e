#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>

#include "core/text.h"
#include "pipeline/store/h5_detail.h"
#include "pipeline/store/seal.h"

namespace npdr::pipeline::h5 {
namespace {

// A text that an HDF5 call fills in: first its length, then itself.
std::string text_of(const std::function<ssize_t(char*, std::size_t)>& call) {
  const ssize_t length = call(nullptr, 0);
  if (length <= 0) return "";
  std::string text(static_cast<std::size_t>(length) + 1, '\0');
  call(text.data(), text.size());
  text.pop_back();
  return text;
}

// Whether a selection is `count` whole rows of an array like `shape`, from row `begin` on. All of a
// part is stored without the part's extents.
bool is_rows(hid_t space, const Shape& shape, Index begin, Index count) {
  if (H5Sget_select_type(space) == H5S_SEL_ALL) return begin == 0;
  if (H5Sget_simple_extent_ndims(space) != static_cast<int>(shape.size())) return false;
  std::vector<hsize_t> first(shape.size()), last(shape.size());
  if (H5Sget_select_bounds(space, first.data(), last.data()) < 0) return false;
  Shape rows = shape;
  rows.front() = count;
  bool is_it = H5Sget_select_npoints(space) == size_of(rows);
  for (std::size_t d = 0; d < shape.size(); ++d) {
    const Index from = d == 0 ? begin : 0;
    is_it = is_it && static_cast<Index>(first[d]) == from &&
            static_cast<Index>(last[d]) == from + rows[d] - 1;
  }
  return is_it;
}

std::size_t num_parts(const Handle& properties) {
  std::size_t count = 0;
  H5Pget_virtual_count(properties.id(), &count);
  return count;
}

// A name that is stored of each part: of its file, or of its dataset.
std::string mapped_name(decltype(&H5Pget_virtual_filename) get, const Handle& properties,
                        std::size_t part) {
  return text_of(
      [&](char* text, std::size_t size) { return get(properties.id(), part, text, size); });
}

std::filesystem::path file_of(const Dataset& dataset) {
  return std::filesystem::canonical(
      text_of([&](char* text, std::size_t size) { return H5Fget_name(dataset.id(), text, size); }));
}

}  // namespace

bool is_virtual(const Object& dataset) {
  return H5Pget_layout(properties_of(dataset).id()) == H5D_VIRTUAL;
}

void check_mapping(const Object& dataset) {
  const Handle properties = properties_of(dataset);
  for (std::size_t i = 0; i < num_parts(properties); ++i) {
    const std::filesystem::path file = mapped_name(H5Pget_virtual_filename, properties, i);
    const bool leaves = file.is_absolute() || std::ranges::find(file, "..") != file.end();
    if (!leaves) continue;
    throw InputError(dataset.where() + ": its part " + quoted(file.string()) +
                     " isn't in the folder of this file, or below it");
  }
}

VirtualParts::VirtualParts(const Dataset& whole)
    : file_(file_of(whole)), shape_(whole.shape()), type_(whole.type()) {
  if (shape_.empty()) throw InputError(whole.where() + ": a single value must be in this file");
  const Handle properties = properties_of(whole);
  const std::vector<std::filesystem::path> files = whole.part_files();
  Index num_rows = 0;
  bool in_order = true;
  for (std::size_t i = 0; i < files.size(); ++i) {
    Part part{.file = files[i],
              .dataset = mapped_name(H5Pget_virtual_dsetname, properties, i),
              .begin = num_rows};
    part.num_rows = opened(part).num_rows();
    num_rows += part.num_rows;
    const Handle in_whole(H5Pget_virtual_vspace(properties.id(), i));
    const Handle in_part(H5Pget_virtual_srcspace(properties.id(), i));
    in_order = in_order && is_rows(in_whole.id(), shape_, part.begin, part.num_rows) &&
               is_rows(in_part.id(), shape_, 0, part.num_rows);
    parts_.push_back(std::move(part));
  }
  if (num_rows != whole.num_rows()) {
    throw InputError(fmt::format("{}: its parts hold {} rows, it claims {}", whole.where(),
                                 num_rows, whole.num_rows()));
  }
  if (!in_order) {
    throw InputError(whole.where() + ": its rows must be those of its parts, one after the other");
  }
}

std::vector<std::filesystem::path> Dataset::part_files() const {
  if (!is_virtual(*this)) return {};
  const Handle properties = properties_of(*this);
  const std::filesystem::path folder = file_of(*this).parent_path();
  std::vector<std::filesystem::path> files;
  for (std::size_t i = 0; i < num_parts(properties); ++i) {
    files.push_back(folder / mapped_name(H5Pget_virtual_filename, properties, i));
    if (std::filesystem::exists(files.back())) continue;
    throw InputError(where() + ": its part '" + files.back().string() +
                     "' is missing; remove the joined file and rerun stage 'simulate'");
  }
  return files;
}

Dataset VirtualParts::opened(const Part& part) const {
  try {
    Dataset dataset = File::open(part.file).dataset(part.dataset);
    Shape expected = shape_;
    expected.front() = part.num_rows;
    dataset.require_shape(expected);
    dataset.require_readable(type_);
    return dataset;
  } catch (const InputError& error) {
    fail(part.file, error);
  }
}

VirtualParts::Piece VirtualParts::from(Index row) {
  const auto next = std::ranges::upper_bound(parts_, row, {}, &Part::begin);
  const Part& part = *std::prev(next);
  if (current_number_ != next - parts_.begin()) {
    current_.emplace(opened(part));
    current_number_ = next - parts_.begin();
  }
  return {*current_, part.file, row - part.begin, part.begin + part.num_rows - row};
}

void VirtualParts::fail(const std::string& part, const InputError& error) const {
  const std::string what = error.what();
  if (!is_damaged(part)) throw Error(what + "; this couldn't be read just now: try again");
  throw DamagedFile(what + "; remove it and '" + file_ +
                    "', which joins it with others, and run again");
}

Dataset Group::create_virtual_dataset(const std::string& name, ElementType type, const Shape& shape,
                                      const std::vector<VirtualSource>& sources) {
  const std::string where = where_of("dataset", name);
  const Handle properties = created(H5Pcreate(H5P_DATASET_CREATE), where, "make a virtual dataset");
  H5Pset_obj_track_times(properties.id(), false);
  const Handle space = make_space(shape);
  Index begin = 0;
  for (const VirtualSource& source : sources) {
    const Handle rows = select_rows(space.id(), shape, begin, source.num_rows);
    written(H5Pset_virtual(properties.id(), space.id(), source.file.c_str(), source.dataset.c_str(),
                           rows.id()),
            where, "map rows of '" + source.file + "'");
    begin += source.num_rows;
  }
  const Handle whole = make_space(shape), stored = file_type(type);
  return {created(H5Dcreate2(id(), name.c_str(), stored.id(), whole.id(), H5P_DEFAULT,
                             properties.id(), H5P_DEFAULT),
                  where, "make it"),
          where};
}

}  // namespace npdr::pipeline::h5
