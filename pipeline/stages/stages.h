/// The stages: each makes one artefact of a plan from the artefacts that it needs.
///
/// A stage whose artefact is there does nothing. Inputs that aren't there are an InputError that
/// says which command makes them. All are resumable: killed at any instant, the next run goes on
/// from the last complete shard or checkpoint and gives the same bits.
#pragma once

#include <vector>

#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

void run_target(const Plan& plan, const Node& node);
void run_propose(const Plan& plan, const Node& node);

/// The shards with these numbers (empty: all), then, once all are there, the artefact that joins
/// them. Throws FailedRolloutsError when more rollouts failed than the study allows.
void run_simulate(const Plan& plan, const Node& node, const std::vector<Index>& shard_numbers = {});
void run_infer(const Plan& plan, const Node& node);
void run_baseline(const Plan& plan, const Node& node);
void run_evaluate(const Plan& plan, const Node& node);
/// Checks a method's posteriors of one seed.
void run_diagnose(const Plan& plan, const Node& node);
/// Searches for a policy under the posterior of an iteration.
void run_policy(const Plan& plan, const Node& node);
/// What a policy does in the target domain, and over the grid.
void run_policy_test(const Plan& plan, const Node& node);
void run_report(const Plan& plan, const Node& node);

/// The stage of the node; throws what it throws.
void run_stage(const Plan& plan, const Node& node, const std::vector<Index>& shard_numbers = {});

/// Whether the node's artefact is there and complete.
bool is_complete(const Plan& plan, const Node& node);

/// Links the uses of a complete artefact, and removes the checkpoint that it may have left behind:
/// the process that made it can have been killed in between.
void settle(const Plan& plan, const Node& node);

/// Throws InputError unless `input`, which `node` needs, is complete: names the command to run. In
/// a batch job waits a minute for it: a network file system may show it late.
void require_input(const Plan& plan, const Node& node, const Node& input);
/// The same for everything that `node` needs.
void require_inputs(const Plan& plan, const Node& node);

}  // namespace npdr::pipeline
