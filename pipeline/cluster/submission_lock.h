/// One submission of a study at a time.
#pragma once

#include <filesystem>

#include "core/open_file.h"

namespace npdr::pipeline {

/// Holds the lock of a folder as long as it lives, or as its process does. Waits for another holder
/// for a minute, then throws Error. A file system without locks has none to give.
class SubmissionLock {
 public:
  explicit SubmissionLock(const std::filesystem::path& folder);

 private:
  OpenFile file_;
};

}  // namespace npdr::pipeline
