/// Recomputes rows of an artefact.
#pragma once

#include <filesystem>
#include <vector>

#include "core/types.h"

namespace npdr::pipeline {

struct Verification {
  Index num_rows = 0;
  Index num_checked = 0;
  std::vector<Index> different;  ///< rows whose bits differ
};

struct VerifyOptions {
  Index count = 10;           ///< rows
  std::uint64_t pick = 0;     ///< picks them
  bool runs_command = false;  ///< that the file names, whoever made it
};

/// Recomputes random rows of a simulation (or one of its shards), with their status, and compares
/// their theta with the proposal's; or rows of a first round's proposal. The target that a
/// simulation was replayed against is found in the cache beside it, as the proposal is. Throws
/// InputError for another kind of file, one whose key isn't that of its key document, and one whose
/// rows come from a program or library that it names itself, unless that may be run.
Verification verify(const std::filesystem::path& given, const VerifyOptions& options);

}  // namespace npdr::pipeline
