/// Where an artefact of a plan stands.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/enum_names.h"
#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

enum class ArtefactState {
  up_to_date,
  stale,    ///< there is one of an earlier version of the study
  partial,  ///< some shards, or a training checkpoint
  missing,
  failed,  ///< its last run failed, or it is a simulation with too many failed rows
};

constexpr auto enum_table(ArtefactState) {
  using enum ArtefactState;
  return std::to_array<EnumRow<ArtefactState>>({{up_to_date, "up to date"},
                                                {stale, "stale"},
                                                {partial, "partial"},
                                                {missing, "missing"},
                                                {failed, "failed"}});
}

struct ArtefactStatus {
  ArtefactState state = ArtefactState::missing;
  /// "3 of 10 shards", "damaged, remove it: ...", "can't be used: ...", why it failed and the log,
  /// or, where it isn't up to date, "what its jobs have said: LOG"; may be empty.
  std::string detail;
  std::uintmax_t bytes = 0;  ///< on disk, shards included
  Cost cost;                 ///< nothing: not known
  bool is_made = false;      ///< complete, and could be read
  bool is_sound = true;      ///< false: it is there, but damaged or can't be read
  /// The artefact of an earlier version, when there is one.
  std::optional<std::filesystem::path> earlier;
};

/// Depth of a look at files: what they say about themselves, or every byte of them.
enum class Scrutiny { quick, thorough };

ArtefactStatus status_of(const Plan& plan, const Node& node, Scrutiny scrutiny = Scrutiny::quick);

/// Processes of this host that make the nodes of a plan now; 0: none does. (nodes)
std::vector<int> processes_at_work(const Plan& plan);

/// Why a node isn't up to date: one line for each key of its key document that differs from the
/// earlier version's, or one that says that there is none; where its jobs' log is. Throws
/// InputError when that one can't be read.
std::vector<std::string> reasons(const Plan& plan, const Node& node);

}  // namespace npdr::pipeline
