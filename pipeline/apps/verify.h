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

/// Recomputes `count` random rows of a simulation (or one of its shards) or of a first round's
/// proposal, or rollouts of a policy's test. The target that a simulation was replayed against is
/// found in the cache beside it. Throws InputError for another kind of file.
Verification verify(const std::filesystem::path& given, Index count, std::uint64_t pick);

}  // namespace npdr::pipeline
