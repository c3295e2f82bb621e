#include <algorithm>

#include "core/text.h"
#include "pipeline/store/h5_detail.h"

namespace npdr::pipeline::h5 {
namespace {

constexpr Index kChunkBytes = 256 << 10;
constexpr Index kMaxChunkBytes = 4 * kChunkBytes;  // HDF5 keeps larger ones out of its cache

std::string located(const std::string& file, const std::string& kind, const std::string& path) {
  return path.empty() ? file : file + ": " + kind + " '" + path + "'";
}

herr_t take_name(hid_t, const char* name, const H5L_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

std::vector<hsize_t> chunk_shape(const Shape& shape, Index element_size, Index rows_per_chunk) {
  Shape chunk = shape;
  const Index row_bytes = size_of(shape) / shape[0] * element_size;
  const Index rows = rows_per_chunk > 0 ? rows_per_chunk : kChunkBytes / row_bytes;
  chunk[0] = std::clamp<Index>(rows, 1, shape[0]);
  for (std::size_t d = 1; d < chunk.size(); ++d) {
    while (size_of(chunk) * element_size > kMaxChunkBytes && chunk[d] > 1) {
      chunk[d] = (chunk[d] + 1) / 2;
    }
  }
  return {chunk.begin(), chunk.end()};
}

// How HDF5 is to store a dataset. Without times of creation, so that equal content gives equal
// files; without chunks where there is nothing to cut.
Handle creation_properties(const Shape& shape, Index element_size, const Storage& storage) {
  Handle properties(H5Pcreate(H5P_DATASET_CREATE));
  H5Pset_obj_track_times(properties.id(), false);
  if (!storage.chunked || shape.empty() || size_of(shape) == 0) return properties;
  const std::vector<hsize_t> chunk = chunk_shape(shape, element_size, storage.rows_per_chunk);
  H5Pset_chunk(properties.id(), static_cast<int>(chunk.size()), chunk.data());
  if (storage.deflate > 0) {
    H5Pset_shuffle(properties.id());
    H5Pset_deflate(properties.id(), static_cast<unsigned>(std::min(storage.deflate, 9)));
  }
  H5Pset_fletcher32(properties.id());
  return properties;
}

}  // namespace

Group::Group(Handle handle, std::string file, std::string path)
    : Object(std::move(handle), located(file, "group", path)),
      file_(std::move(file)),
      path_(std::move(path)) {}

std::vector<std::string> Group::names() const {
  std::vector<std::string> names;
  if (H5Literate(id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, take_name, &names) < 0) {
    fail_reading(where(), "list what it holds");
  }
  std::sort(names.begin(), names.end());
  return names;
}

bool Group::has(const std::string& name) const {
  return is_true(H5Lexists(id(), name.c_str(), H5P_DEFAULT), where()) &&
         is_true(H5Oexists_by_name(id(), name.c_str(), H5P_DEFAULT), where());
}

bool Group::is_group(const std::string& name) const {
  H5O_info_t info;
  return has(name) &&
         H5Oget_info_by_name2(id(), name.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT) >= 0 &&
         info.type == H5O_TYPE_GROUP;
}

// Why a member can't be used that there is no object for.
std::string Group::lack_of(std::string_view kind, const std::string& name) const {
  const bool is_link = is_true(H5Lexists(id(), name.c_str(), H5P_DEFAULT), where()) && !has(name);
  if (!is_link) return where() + ": " + missing_name(kind, name, names());
  return where() + ": '" + name +
         "' is a link that leads nowhere in this file, must be in the file itself";
}

std::string Group::path_of(const std::string& name) const {
  return path_.empty() ? name : path_ + "/" + name;
}

std::string Group::where_of(const char* kind, const std::string& name) const {
  return located(file_, kind, path_of(name));
}

Group Group::group(const std::string& name) const {
  if (!is_group(name)) throw InputError(lack_of("group", name));
  return {opened(H5Gopen2(id(), name.c_str(), H5P_DEFAULT), where_of("group", name), "be opened"),
          file_, path_of(name)};
}

Dataset Group::dataset(const std::string& name) const {
  if (!has(name) || is_group(name)) throw InputError(lack_of("dataset", name));
  const std::string at = where_of("dataset", name);
  return {opened(H5Dopen2(id(), name.c_str(), H5P_DEFAULT), at, "be opened"), at};
}

Group Group::create_group(const std::string& name) {
  const Handle properties(H5Pcreate(H5P_GROUP_CREATE));
  H5Pset_obj_track_times(properties.id(), false);
  return {created(H5Gcreate2(id(), name.c_str(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
                  where_of("group", name), "be created"),
          file_, path_of(name)};
}

Dataset Group::create_dataset(const std::string& name, ElementType type, const Shape& shape,
                              const Storage& storage) {
  prepare();
  const std::string at = where_of("dataset", name);
  const Handle stored = file_type(type);
  const Handle space = make_space(shape);
  const auto element_size = static_cast<Index>(H5Tget_size(stored.id()));
  const Handle properties = creation_properties(shape, element_size, storage);
  Handle dataset = created(H5Dcreate2(id(), name.c_str(), stored.id(), space.id(), H5P_DEFAULT,
                                      properties.id(), H5P_DEFAULT),
                           at, "be created");
  // Closing a dataset writes its last chunks, and a destructor couldn't tell that this failed: keep
  // it open until File::close(), which can.
  H5Iinc_ref(dataset.id());
  return {std::move(dataset), at};
}

void Group::write_texts(const std::string& name, const std::vector<std::string>& texts) {
  const Shape shape = {static_cast<Index>(texts.size())};
  create_dataset(name, ElementType::text, shape, {.chunked = false}).write_texts(texts);
}

void Group::write_text(const std::string& name, const std::string& text) {
  create_dataset(name, ElementType::text, {}).write_texts({text});
}

std::vector<std::string> Group::read_texts(const std::string& name) const {
  const Dataset stored = dataset(name);
  stored.require_shape({-1});
  return stored.read_texts();
}

std::string Group::read_text(const std::string& name) const {
  const Dataset stored = dataset(name);
  stored.require_shape({});
  return stored.read_texts().front();
}

}  // namespace npdr::pipeline::h5
