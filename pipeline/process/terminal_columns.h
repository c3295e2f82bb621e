/// Width of the terminal that people read a program's output on.
#pragma once

#include <optional>

namespace npdr::pipeline {

/// Columns of the terminal that stdout is, as it is now; none where it is a file or a pipe.
std::optional<int> terminal_columns();

}  // namespace npdr::pipeline
