#include "pipeline/run/run_stage.h"

#include "pipeline/plan/completeness.h"
#include "pipeline/report/report.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {

void run_stage(const Plan& plan, const Node& node, const std::vector<Index>& shard_numbers) {
  if (is_complete(plan, node)) {
    settle(plan, node);
    return;
  }
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

}  // namespace npdr::pipeline
