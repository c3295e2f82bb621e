#include "pipeline/run/run_stage.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/error.h"
#include "core/stop_request.h"
#include "pipeline/plan/completeness.h"
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

// By their values.
template <int... i>
constexpr auto all_runs(std::integer_sequence<int, i...>) {
  return std::array{&run<Stage{i}>...};
}

}  // namespace

void run_stage(const Plan& plan, const Node& node, const std::vector<Index>& shard_numbers) {
  if (is_complete(plan, node)) {
    settle(plan, node);
    return;
  }
  if (saves_work_on_request(plan, node)) watch_for_stop_requests();
  require_inputs(plan, node);
  constexpr auto runs = all_runs(std::make_integer_sequence<int, enum_table(Stage{}).size()>());
  runs[static_cast<std::size_t>(node.stage)](plan, node, shard_numbers);
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
