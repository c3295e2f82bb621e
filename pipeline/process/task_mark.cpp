#include "pipeline/process/task_mark.h"

#include <fcntl.h>

#include <cstdlib>

#include "core/open_file.h"

namespace npdr::pipeline {

void mark_progress() noexcept {
  const char* const path = std::getenv(kTaskMark);
  if (path == nullptr) return;
  constexpr unsigned only_ours = 0600;
  const OpenFile mark(path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW, only_ours);
}

}  // namespace npdr::pipeline
