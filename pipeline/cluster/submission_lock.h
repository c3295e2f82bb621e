/// One submission of a study at a time.
#pragma once

#include <filesystem>

namespace npdr::pipeline {

/// Holds the lock of a folder as long as it lives, or as its process does. Waits for another holder
/// for a minute, then throws Error. A file system without locks has none to give.
class SubmissionLock {
 public:
  explicit SubmissionLock(const std::filesystem::path& folder);
  ~SubmissionLock();
  SubmissionLock(const SubmissionLock&) = delete;
  SubmissionLock& operator=(const SubmissionLock&) = delete;

 private:
  int file_ = -1;
};

}  // namespace npdr::pipeline
