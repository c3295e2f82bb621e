#include "pipeline/stages/stages.h"

#include <unistd.h>

#include "core/error.h"
#include "pipeline/run/stop_request.h"
#include "pipeline/stages/report_marker.h"
#include "pipeline/store/batch_job.h"

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

bool is_complete(const Plan& plan, const Node& node) {
  if (node.stage == Stage::report) return report_is_current(plan, node);
  return std::filesystem::exists(node.path);
}

void settle(const Plan& plan, const Node& node) {
  link_uses(plan, node);
  std::error_code ignored;
  if (node.stage == Stage::infer || node.stage == Stage::policy) {
    std::filesystem::remove(plan.work.checkpoint(to_string(node.stage), node.key), ignored);
  }
}

namespace {

// On a network file system a machine may not see for a while what another one has just made, and
// a batch job begins at that very moment. Looking through the folder asks the server.
bool appears(const Plan& plan, const Node& input) {
  constexpr int patience = 60;  // [s]
  for (int second = 0; second < patience && !batch_job_id().empty(); ++second) {
    std::error_code ignored;
    for (std::filesystem::directory_iterator entry(input.path.parent_path(), ignored), end;
         !ignored && entry != end; entry.increment(ignored)) {
    }
    if (is_complete(plan, input)) return true;
    if (stop_requested()) return false;
    sleep(1);
  }
  return is_complete(plan, input);
}

}  // namespace

void require_input(const Plan& plan, const Node& node, const Node& input) {
  if (is_complete(plan, input) || appears(plan, input)) return;
  throw InputError(node.label() + " needs '" + input.label() + "', which isn't there; run " +
                   program_of(input.stage) + " on this study first, or npdr run");
}

void require_inputs(const Plan& plan, const Node& node) {
  for (const std::size_t i : node.needs) require_input(plan, node, plan.nodes[i]);
}

}  // namespace npdr::pipeline
