/// Provenance: this build of the program, and the time.
#pragma once

#include <string>

namespace npdr::pipeline {

/// Version of the project, such as "0.1.0".
std::string creator_version();

/// The git revision that was built, with "-dirty" when files were changed since; "unknown" when the
/// source tree isn't a git checkout.
std::string git_revision();

/// Instructions that the compiler was allowed to use, such as "x86-64 avx2 fma avx512f". Bits of
/// results may differ between instruction sets.
std::string instruction_set();

/// Now, such as "2024-03-01T12:00:00Z". Nothing is decided by it.
std::string now_utc();

}  // namespace npdr::pipeline
