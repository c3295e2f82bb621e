#include <algorithm>
#include <system_error>

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

std::vector<hsize_t> chunk_shape(const Shape& shape, Index element_size) {
  Shape chunk = shape;
  const Index row_bytes = size_of(shape) / shape[0] * element_size;
  chunk[0] = std::clamp<Index>(kChunkBytes / row_bytes, 1, shape[0]);
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
  const std::vector<hsize_t> chunk = chunk_shape(shape, element_size);
  H5Pset_chunk(properties.id(), static_cast<int>(chunk.size()), chunk.data());
  if (storage.deflate > 0) {
    H5Pset_shuffle(properties.id());
    H5Pset_deflate(properties.id(), static_cast<unsigned>(std::min(storage.deflate, 9)));
  }
  H5Pset_fletcher32(properties.id());
  return properties;
}

// Closing a new file closes all that is open in it; one that is read stays open as long as
// something of it is in use, because virtual datasets open their parts like that too and all users
// of a file must agree. New files are in the format of HDF5 1.10, whose metadata has checksums: bit
// rot is found there too.
Handle access_properties(bool is_new) {
  Handle properties(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_fclose_degree(properties.id(), is_new ? H5F_CLOSE_STRONG : H5F_CLOSE_WEAK);
  H5Pset_libver_bounds(properties.id(), H5F_LIBVER_V110, H5F_LIBVER_LATEST);
  H5Pset_file_locking(properties.id(), false, /*ignore_when_disabled=*/true);
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
  Storage how = storage;
  how.chunked &= type != ElementType::text;
  const Handle properties = creation_properties(shape, element_size, how);
  Handle dataset = created(H5Dcreate2(id(), name.c_str(), stored.id(), space.id(), H5P_DEFAULT,
                                      properties.id(), H5P_DEFAULT),
                           at, "be created");
  // Closing a dataset writes its last chunks, and a destructor couldn't tell that this failed: keep
  // it open until File::close(), which can.
  H5Iinc_ref(dataset.id());
  return {std::move(dataset), at};
}

File::File(Handle handle, const std::string& shown_as, bool is_new)
    : Group(std::move(handle), shown_as, ""), is_new_(is_new) {}

// Closing a file that can't be written (the disk is full) leaves HDF5 with identifiers of freed
// memory: any later call may crash. An abandoned file stays open until the process ends instead.
File::~File() {
  if (is_new_) release();
}

File File::create(const std::filesystem::path& path, const std::string& shown_as) {
  prepare();
  const std::string name = path.string();
  const std::string shown = shown_as.empty() ? name : shown_as;
  const Handle creation(H5Pcreate(H5P_FILE_CREATE));
  H5Pset_obj_track_times(creation.id(), false);
  const Handle access = access_properties(true);
  return {created(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), shown,
                  "be created"),
          shown, true};
}

File File::open(const std::filesystem::path& path) {
  prepare();
  const std::string name = path.string();
  std::error_code unreadable;  // HDF5 says why
  const auto type = std::filesystem::status(path, unreadable).type();
  if (type == std::filesystem::file_type::not_found) throw InputError(name + ": doesn't exist");
  if (type == std::filesystem::file_type::directory) {
    throw InputError(name + ": is a folder, must be an HDF5 file");
  }
  // A pipe would be waited for without end.
  if (std::filesystem::exists(path, unreadable) &&
      !std::filesystem::is_regular_file(path, unreadable)) {
    throw InputError(name + ": isn't a regular file, must be an HDF5 file");
  }
  if (H5Fis_hdf5(name.c_str()) == 0) throw InputError(name + ": isn't an HDF5 file");
  const Handle access = access_properties(false);
  return {opened(H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.id()), name, "be opened"), name,
          false};
}

void File::close() {
  require_sound();
  const hid_t file = release();
  written(H5Fflush(file, H5F_SCOPE_GLOBAL), where(), "be written");
  written(H5Fclose(file), where(), "be closed");
}

}  // namespace npdr::pipeline::h5
