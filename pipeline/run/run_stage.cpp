#include "pipeline/run/run_stage.h"

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
  switch (node.stage) {
    case Stage::simulate:
    case Stage::infer:
    case Stage::baseline:
    case Stage::diagnose:
    case Stage::policy:
    case Stage::policy_test:
      return true;
    case Stage::report:
      return false;
    default:
      return plan.study.source().calls_program;
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
  switch (node.stage) {
    case Stage::target:
    case Stage::held_out:
      run_target(plan, node);
      break;
    case Stage::propose:
      run_propose(plan, node);
      break;
    case Stage::simulate:
      run_simulate(plan, node, shard_numbers);
      break;
    case Stage::infer:
      run_infer(plan, node);
      break;
    case Stage::baseline:
      run_baseline(plan, node);
      break;
    case Stage::evaluate:
      run_evaluate(plan, node);
      break;
    case Stage::diagnose:
      run_diagnose(plan, node);
      break;
    case Stage::policy:
      run_policy(plan, node);
      break;
    case Stage::policy_test:
      run_policy_test(plan, node);
      break;
    case Stage::report:
      run_report(plan, node);
      break;
  }
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
