// Calls of the C library that fail on purpose, in programs that this library is loaded into
// (LD_PRELOAD). Environment variables say which:
//
//   NPDR_FAIL        name of the call, such as "write"
//   NPDR_FAIL_ERRNO  number of its error; 0: reads and writes do half of what they are asked for
//   NPDR_FAIL_AT     which of the process's calls fails, counted from 1; 0: all of them
//   NPDR_FAIL_UNDER  only calls about files whose path holds this text count; of a folder's whole
//                    path also those about relative ones
//   NPDR_FAIL_IN     only programs of this name
//   NPDR_FAIL_NOTE   a file that gets a line for each failure
//
// Nothing in here allocates: it may be called from anywhere.
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/signalfd.h>
#include <sys/types.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstddef>

namespace {

// What a call does otherwise.
template <class Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

long number_of(const char* variable) {
  const char* const text = getenv(variable);
  return text == nullptr ? 0 : atol(text);
}

bool is_of_this_program() {
  const char* const wanted = getenv("NPDR_FAIL_IN");
  return wanted == nullptr || strcmp(wanted, program_invocation_short_name) == 0;
}

bool counts(const char* path) {
  const char* const wanted = getenv("NPDR_FAIL_UNDER");
  if (wanted == nullptr) return true;
  if (path == nullptr) return false;
  return strstr(path, wanted) != nullptr || (wanted[0] == '/' && path[0] != '/');
}

void note(const char* name, const char* path) {
  const char* const file = getenv("NPDR_FAIL_NOTE");
  if (file == nullptr) return;
  std::array<char, 600> line;
  const int size = snprintf(line.data(), line.size(), "%s %s\n", name, path);
  const int descriptor = real<int(const char*, int, ...)>("open")(
      file, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  real<ssize_t(int, const void*, size_t)>("write")(descriptor, line.data(),
                                                   static_cast<std::size_t>(size));
  real<int(int)>("close")(descriptor);
}

// Whether this call is one that fails; then errno is set.
bool fails(const char* name, const char* path) {
  static std::atomic<long> count = 0;
  const char* const wanted = getenv("NPDR_FAIL");
  if (wanted == nullptr || strcmp(wanted, name) != 0 || !is_of_this_program() || !counts(path)) {
    return false;
  }
  const long at = number_of("NPDR_FAIL_AT");
  if (++count != at && at != 0) return false;
  note(name, path == nullptr ? "" : path);
  errno = static_cast<int>(number_of("NPDR_FAIL_ERRNO"));
  return true;
}

// The same of a call about an open file.
bool fails(const char* name, int descriptor) {
  const int before = errno;
  std::array<char, 32> link;
  std::array<char, 512> path{};
  snprintf(link.data(), link.size(), "/proc/self/fd/%d", descriptor);
  [[maybe_unused]] const ssize_t size = readlink(link.data(), path.data(), path.size() - 1);
  errno = before;
  return fails(name, path.data());
}

mode_t mode_in(int flags, va_list& arguments) {
  const bool has_mode = (flags & (O_CREAT | O_TMPFILE)) != 0;
  return has_mode ? static_cast<mode_t>(va_arg(arguments, int)) : 0;
}

// A call that reads or writes bytes, which may be cut short.
template <class Bytes, class... At>
ssize_t transfer(const char* name, int file, Bytes* bytes, std::size_t count, At... at) {
  const bool is_cut = fails(name, file);
  if (is_cut && errno != 0) return -1;
  const std::size_t some = is_cut && count > 1 ? count / 2 : count;
  return real<ssize_t(int, Bytes*, std::size_t, At...)>(name)(file, bytes, some, at...);
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_in(flags, arguments);
  va_end(arguments);
  return fails("open", path) ? -1 : real<int(const char*, int, ...)>("open")(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_in(flags, arguments);
  va_end(arguments);
  return fails("open", path) ? -1 : real<int(const char*, int, ...)>("open64")(path, flags, mode);
}

ssize_t read(int file, void* bytes, std::size_t count) {
  return transfer("read", file, bytes, count);
}

ssize_t pread(int file, void* bytes, std::size_t count, off_t at) {
  return transfer("pread", file, bytes, count, at);
}

ssize_t pread64(int file, void* bytes, std::size_t count, off64_t at) {
  return pread(file, bytes, count, at);
}

ssize_t write(int file, const void* bytes, std::size_t count) {
  return transfer("write", file, bytes, count);
}

ssize_t pwrite(int file, const void* bytes, std::size_t count, off_t at) {
  return transfer("pwrite", file, bytes, count, at);
}

ssize_t pwrite64(int file, const void* bytes, std::size_t count, off64_t at) {
  return pwrite(file, bytes, count, at);
}

int fsync(int file) { return fails("fsync", file) ? -1 : real<int(int)>("fsync")(file); }

int rename(const char* from, const char* to) {
  return fails("rename", from) ? -1 : real<int(const char*, const char*)>("rename")(from, to);
}

// As Linux does, which frees the descriptor whatever it answers.
int close(int file) {
  const bool is_lost = fails("close", file);
  const int error = errno;
  const int status = real<int(int)>("close")(file);
  if (!is_lost) return status;
  errno = error;
  return -1;
}

int signalfd(int file, const sigset_t* signals, int flags) noexcept {
  if (fails("signalfd", nullptr)) return -1;
  return real<int(int, const sigset_t*, int)>("signalfd")(file, signals, flags);
}

int flock(int file, int operation) {
  return fails("flock", file) ? -1 : real<int(int, int)>("flock")(file, operation);
}

}  // extern "C"
