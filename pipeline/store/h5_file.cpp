#include <atomic>
#include <cerrno>
#include <system_error>

#include "pipeline/store/h5_detail.h"

namespace npdr::pipeline::h5 {
namespace {

// Locks where the file system has them. Closing a new file closes all that is open in it; one that
// is read stays open as long as something of it is in use, because virtual datasets open their
// parts like that too and all users of a file must agree. New files are in the format of HDF5 1.10,
// whose metadata has checksums: bit rot is found there too.
Handle access_properties(bool locks, bool is_new) {
  Handle properties(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_fclose_degree(properties.id(), is_new ? H5F_CLOSE_STRONG : H5F_CLOSE_WEAK);
  H5Pset_libver_bounds(properties.id(), H5F_LIBVER_V110, H5F_LIBVER_LATEST);
  H5Pset_file_locking(properties.id(), locks, /*ignore_when_disabled=*/true);
  return properties;
}

// HDF5 goes on without a lock by itself only when the file system says ENOSYS; others say ENOLCK
// or EOPNOTSUPP. EAGAIN means that somebody has the lock.
bool file_system_has_no_locks(const std::string& message) {
  return message.find("unable to lock file") != std::string::npos &&
         message.find(std::generic_category().message(EAGAIN)) == std::string::npos;
}

// A file can't be open with and without locks at the same time.
bool is_open_the_other_way(const std::string& message) {
  return message.find("locking flag values don't match") != std::string::npos;
}

// Whether this process asks for locks: until a file system has none.
std::atomic<bool>& asks_for_locks() {
  static std::atomic<bool> asks = true;
  return asks;
}

// `open` takes access properties and throws with HDF5's reason.
template <class Open>
Handle with_locks_if_possible(bool is_new, const Open& open) {
  const bool locks = asks_for_locks();
  try {
    return open(access_properties(locks, is_new).id());
  } catch (const Error& error) {
    const bool has_none = locks && file_system_has_no_locks(error.what());
    if (!has_none && !is_open_the_other_way(error.what())) throw;
    if (has_none) asks_for_locks() = false;
  }
  return open(access_properties(!locks, is_new).id());
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
  const auto create = [&](hid_t access) {
    return created(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, creation.id(), access), shown,
                   "be created");
  };
  return {with_locks_if_possible(true, create), shown, true};
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
  const auto open = [&](hid_t access) {
    return opened(H5Fopen(name.c_str(), H5F_ACC_RDONLY, access), name, "be opened");
  };
  return {with_locks_if_possible(false, open), name, false};
}

void File::close() {
  require_sound();
  const hid_t file = release();
  written(H5Fflush(file, H5F_SCOPE_GLOBAL), where(), "be written");
  written(H5Fclose(file), where(), "be closed");
}

}  // namespace npdr::pipeline::h5
