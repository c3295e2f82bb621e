/// How a batch task learns whether what it ran has brought anything to the disk.
#pragma once

namespace npdr::pipeline {

/// The variable that names the mark's file to the programs of a task.
inline constexpr const char* kTaskMark = "NPDR_TASK_MARK";

/// Makes the mark, if this process is a part of a task: an artefact, shard or checkpoint is there
/// now. Never throws.
void mark_progress() noexcept;

}  // namespace npdr::pipeline
