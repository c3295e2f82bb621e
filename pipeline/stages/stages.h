/// The stages: run<Stage::NAME>() (plan.h) makes one artefact of a plan from the artefacts that it
/// needs, which are there. Here is what else they offer.
///
/// Killed at any instant, the next call gives the same bits: simulations go on from their last
/// shard, trainings, diagnoses and policy searches from their last checkpoint, the others begin
/// anew.
///
/// Each throws InputError for a damaged input or a number that no shard has, FailedRolloutsError
/// when more rows of a simulation failed than the study allows, Error when a truth can't be
/// simulated or writing fails, Checkpointed when it is asked to stop.
#pragma once

#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// A helper of a refinement: number 1, 2, ... of so many; 0: the refinement itself.
struct Helper {
  Index number = 1;
  Index count = 1;
};
/// Seconds that a helper waits for rows to simulate before it gives up: the refinement may be
/// thinking, but it may also have been killed, or be waiting in a queue.
inline constexpr double kHelperPatience = 600.0;
/// Simulates the rows that the refinement `node` asks for, together with it, until its artefact is
/// complete or nothing was asked for in `patience` seconds. Waits as long for what `node` needs,
/// too. Returns the number of rows. Throws as stages do, and InputError when its inputs don't come.
Index help_refinement(const Plan& plan, const Node& node, const Helper& helper,
                      double patience = kHelperPatience);

}  // namespace npdr::pipeline
