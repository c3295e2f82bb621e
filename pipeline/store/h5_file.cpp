#include <system_error>

#include "pipeline/store/h5_detail.h"

namespace npdr::pipeline::h5 {
namespace {

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
