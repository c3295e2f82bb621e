#include <cmath>

#include "core/constants.h"
#include "core/random.h"
#include "core/stop_request.h"
#include "pipeline/artefacts/policy_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/predictions/policy_rollouts.h"
#include "pipeline/process/progress.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

// Each row of theta (rows, P) from each initial state, block by block.
PolicyOutcomes try_policy(const Node& node, const sim::PolicyTask& task, const RowMatrix& theta,
                          const PolicyTest& test) {
  const Index n = test.initial_states.rows();
  Progress progress(node.label(), theta.rows() * n);
  PolicyOutcomes outcomes{RowMatrix(theta.rows(), n), RowMatrix(theta.rows(), n)};
  for (Index i = 0; i < theta.rows(); ++i) {
    stop_here_if_requested();
    const sim::PolicyRollouts rollouts = task.run(theta.row(i).replicate(n, 1), test.initial_states,
                                                  test.policy.transpose().replicate(n, 1));
    outcomes.returns.row(i) = rollouts.returns.transpose();
    for (Index s = 0; s < n; ++s) {
      const bool is_ok = std::isfinite(rollouts.returns(s));
      outcomes.success(i, s) = is_ok ? rollouts.success[static_cast<std::size_t>(s)] : kNaN;
    }
    progress.update((i + 1) * n);
  }
  return outcomes;
}

PolicyOutcomes part_of(const PolicyOutcomes& all, Index begin, Index count) {
  return {all.returns.middleRows(begin, count), all.success.middleRows(begin, count)};
}

}  // namespace

void run_policy_test(const Plan& plan, const Node& node) {
  ArtefactWriter writer(node.path, kPolicyTestSchema, node.identity);
  const Study& study = plan.study;
  const auto task = make_task(study);
  const Node* policy = plan.find_input(node, "policy");
  PolicyTest test;
  test.policy =
      policy == nullptr ? first_policy(study, task->info()) : kPolicySchema.read(*policy).policy;
  // The same for all policies of a seed.
  test.initial_states = task->initial_states(study.policy.num_test_states,
                                             {node.uses.front().seed, "policy_test", 0, 0, 0});

  const RowMatrix theta = tested_parameters(study, *plan.source);
  const PolicyOutcomes all = try_policy(node, *task, theta, test);
  const Index num_targets = study.target.truth ? 1 : 0, num_points = theta.rows() - num_targets;
  if (num_targets > 0) test.target = part_of(all, 0, num_targets);
  if (num_points > 0) test.grid = part_of(all, num_targets, num_points);
  test.info = task->info();
  test.states = sim::make_simulator(study.simulator)->info().state_channels;
  test.axes = study.policy.grid;
  kPolicyTestSchema.write(writer.file(), std::move(test));
  writer.finish();
}

}  // namespace npdr::pipeline
