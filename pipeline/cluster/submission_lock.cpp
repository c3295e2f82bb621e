#include "pipeline/cluster/submission_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/file_error.h"

namespace npdr::pipeline {

SubmissionLock::SubmissionLock(const std::filesystem::path& folder) {
  make_folder(folder);
  const std::filesystem::path path = folder / ".lock";
  file_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (file_ < 0) throw_file_error(path, "be written", errno);
  constexpr int patience = 600;
  constexpr useconds_t pause = 100'000;  // [us]
  for (int i = 0; i < patience && flock(file_, LOCK_EX | LOCK_NB) != 0; ++i) {
    if (errno != EWOULDBLOCK && errno != EINTR) return;  // there are no locks here
    if (i + 1 == patience) {
      close(file_);
      throw Error(path.string() + ": somebody else submits this study; try again later");
    }
    usleep(pause);
  }
}

SubmissionLock::~SubmissionLock() { close(file_); }

}  // namespace npdr::pipeline
