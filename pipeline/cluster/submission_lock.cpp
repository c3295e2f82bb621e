#include "pipeline/cluster/submission_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/file_error.h"

namespace npdr::pipeline {
namespace {

std::filesystem::path lock_in(const std::filesystem::path& folder) {
  make_folder(folder);
  return folder / ".lock";
}

}  // namespace

SubmissionLock::SubmissionLock(const std::filesystem::path& folder)
    : file_(lock_in(folder), O_RDWR | O_CREAT | O_NOFOLLOW) {
  const std::filesystem::path path = folder / ".lock";
  if (!file_.is_open()) throw_file_error(path, "be written", errno);
  constexpr int patience = 600;
  constexpr useconds_t pause = 100'000;  // [us]
  for (int i = 0; i < patience; ++i) {
    if (flock(file_.value(), LOCK_EX | LOCK_NB) == 0) return;
    if (errno != EWOULDBLOCK && errno != EINTR) return;  // there are no locks here
    usleep(pause);
  }
  throw Error(path.string() + ": somebody else submits this study; try again later");
}

}  // namespace npdr::pipeline
