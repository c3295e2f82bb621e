#include "pipeline/run/run_stage.h"

#include <algorithm>

#include "core/error.h"
#include "core/stop_request.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/report/report.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

// Others are short, or begin anew after they have been ended; programs of the user's are ended
// gently in any case.
bool saves_work_on_request(const Plan& plan, const Node& node) {
  using enum Stage;
  constexpr Stage saving[] = {simulate, infer, baseline, diagnose, policy, policy_test};
  if (std::ranges::count(saving, node.stage) > 0) return true;
  return node.stage != report && plan.study.source().calls_program;
}

// No default: the compiler tells which stage is missing.
void make(const Plan& plan, const Node& node, const std::vector<Index>& shard_numbers) {
  switch (node.stage) {
    case Stage::target:
    case Stage::held_out:
      return run_target(plan, node);
    case Stage::propose:
      return run_propose(plan, node);
    case Stage::simulate:
      return run_simulate(plan, node, shard_numbers);
    case Stage::infer:
      return run_infer(plan, node);
    case Stage::baseline:
      return run_baseline(plan, node);
    case Stage::evaluate:
      return run_evaluate(plan, node);
    case Stage::diagnose:
      return run_diagnose(plan, node);
    case Stage::policy:
      return run_policy(plan, node);
    case Stage::policy_test:
      return run_policy_test(plan, node);
    case Stage::report:
      return run_report(plan, node);
  }
}

}  // namespace

void run_stage(const Plan& plan, const Node& node, const std::vector<Index>& shard_numbers) {
  if (is_complete(plan, node)) {
    settle(plan, node);
    return;
  }
  if (saves_work_on_request(plan, node)) watch_for_stop_requests();
  require_inputs(plan, node);
  make(plan, node, shard_numbers);
  if (is_complete(plan, node)) settle(plan, node);
}

Index run_helper(const Plan& plan, const Node& node, const Helper& helper) {
  if (!is_refinement(plan, node)) {
    throw InputError(node.label() +
                     ": has no rows to help with, must be a posterior of the algorithm 'refine'; "
                     "'npdr run STUDY --dry-run' lists all artefacts with their keys");
  }
  Index num_rows = 0;
  if (!is_complete(plan, node)) {
    watch_for_stop_requests();
    num_rows = help_refinement(plan, node, helper);
  }
  if (is_complete(plan, node)) settle(plan, node);
  return num_rows;
}

}  // namespace npdr::pipeline
