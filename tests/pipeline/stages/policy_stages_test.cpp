#include "core/error.h"
#include "pipeline/artefacts/policy_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/features/observation.h"
#include "pipeline/predictions/policy_rollouts.h"
#include "pipeline/run/run_stage.h"
#include "pipeline/stages/stages.h"
#include "tests/study_text.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

std::string two_searches() {
  return furuta_study("policies")
      .with("target", {"truth = { pole_mass = 0.02 }", "num_rollouts = 2"})
      .method("Randomized", {"algorithm = \"prior\"", "policy_iterations = 2"})
      .method("Point", {"algorithm = \"nominal\"", "policy_iterations = 2"})
      .with("policy", few_trials())
      .with("policy", {"population = 3", "num_steps = 60"})
      .with("policy.grid", {"x = { parameter = \"pole_mass\", range = [0.02, 0.03], steps = 2 }",
                            "y = { parameter = \"gravity\", values = [9.0, 9.8, 10.0] }"});
}

class PolicyStages : public FolderTest {
 protected:
  Plan plan(const std::vector<std::string>& overrides = {}) const {
    return make_plan(parse_study(two_searches(), "p.toml", overrides), WorkFolder(folder_.path()));
  }
};

double parameter(const Plan& plan, const RowMatrix& theta, Index row, const char* name) {
  const auto info = sim::make_simulator(plan.study.simulator)->info();
  return theta(row, sim::parameter_index(info, name));
}

TEST_F(PolicyStages, TheTargetComesFirstThenTheGridWithYFastest) {
  const Plan p = plan();
  const RowMatrix theta = tested_parameters(p.study, *p.source);
  ASSERT_EQ(theta.rows(), 1 + 2 * 3);
  EXPECT_EQ(parameter(p, theta, 0, "pole_mass"), 0.02);
  EXPECT_EQ(parameter(p, theta, 2, "pole_mass"), 0.02);
  EXPECT_EQ(parameter(p, theta, 2, "gravity"), 9.8);
  EXPECT_EQ(parameter(p, theta, 4, "pole_mass"), 0.03);
  EXPECT_EQ(parameter(p, theta, 4, "gravity"), 9.0);
  EXPECT_EQ(parameter(p, theta, 4, "pole_length"), parameter(p, theta, 0, "pole_length"));
}

TEST_F(PolicyStages, ASearchBeginsWithTheStudysPolicy) {
  const Plan p = plan();
  const auto task = make_task(p.study);
  Vector expected = sim::initial_policy(task->info());
  expected(1) = 20.0;  // energy_gain
  EXPECT_EQ(first_policy(p.study, task->info()), expected);
  EXPECT_EQ(task->info().num_steps, 60);
}

// Collected rollouts are what the simulator itself does from their first state under their actions.
void expect_replays(const Plan& plan, const Target& collected) {
  const auto simulator = sim::make_simulator(plan.study.simulator);
  const Vector truth = plan.source->parameters().nominal(*plan.study.target.truth);
  const sim::Trajectories replayed = simulator->replay(collected, truth.transpose());
  for (Index h = 0; h < collected.num_rollouts(); ++h) {
    const Rollout& rollout = collected.rollouts[static_cast<std::size_t>(h)];
    const RowMatrix states = replayed.rollout(0, h).cast<double>();
    const double error = (states - rollout.states.bottomRows(states.rows())).cwiseAbs().maxCoeff();
    EXPECT_LT(error, 1e-4) << h;  // single precision of rates up to about 30 rad/s
  }
}

TEST_F(PolicyStages, CollectedRolloutsAreLikeTheFirstOnes) {
  const Plan p = plan();
  const Target like = p.source->behave({});
  const auto task = make_task(p.study);
  const Vector policy = first_policy(p.study, task->info());
  const Target collected = collect_rollouts(p, like, policy, 3, {1, "policy_rollouts", 2, 0, 0});
  collected.check("collected");
  EXPECT_EQ(collected.num_rollouts(), 3);
  EXPECT_EQ(collected.num_steps(), like.num_steps());
  EXPECT_EQ(collected.rollouts[1].name, "iteration 2, rollout 2");
  EXPECT_NE(collected.rollouts[0].states, collected.rollouts[1].states);
  expect_replays(p, collected);
  const Target again = collect_rollouts(p, like, policy, 1, {1, "policy_rollouts", 2, 0, 0});
  EXPECT_EQ(again.rollouts[0].states, collected.rollouts[0].states) << "whatever the number";
}

TEST_F(PolicyStages, APolicyThatLeavesTheLimitsIsSwitchedOff) {
  const Plan p = plan();
  const Target like = p.source->behave({});
  const auto task = make_task(p.study, like.num_steps());
  Vector policy = first_policy(p.study, task->info());
  policy(2) = -50.0;  // the arm is pushed away from its center
  const Target collected = collect_rollouts(p, like, policy, 1, {1, "policy_rollouts", 2, 0, 0});
  collected.check("collected");
  const Rollout& rollout = collected.rollouts.front();
  EXPECT_GT(rollout.states.col(0).cwiseAbs().maxCoeff(), 2.0) << "115 degrees";
  EXPECT_NE(rollout.actions(0, 0), 0.0);
  EXPECT_EQ(rollout.actions.bottomRows(100).cwiseAbs().maxCoeff(), 0.0);
  expect_replays(p, collected);
}

TEST_F(PolicyStages, ATestIsWhatThePolicyDoesFromItsStates) {
  const Plan p = plan();
  const Node& node = p.node(Stage::policy_test, {"Point", 1, 0, 0});
  run_stage(p, node);
  const PolicyTest test = kPolicyTestSchema.read(node);
  ASSERT_TRUE(test.target && test.grid);
  EXPECT_EQ(test.initial_states.rows(), 20);
  EXPECT_EQ(test.grid->returns.rows(), 6);
  const auto task = make_task(p.study);
  EXPECT_EQ(test.policy, first_policy(p.study, task->info()));
  const RowMatrix theta = tested_parameters(p.study, *p.source);
  const auto one = [&](Index point, Index state) {
    return task->run(theta.row(point), test.initial_states.row(state), test.policy.transpose())
        .returns(0);
  };
  EXPECT_EQ(test.target->returns(0, 7), one(0, 7));
  EXPECT_EQ(test.grid->returns(4, 3), one(5, 3));
}

TEST_F(PolicyStages, WithARecordingThereIsTheGridAlone) {
  const std::vector<std::string> recorded = {"target.recording=" + (folder_ / "r.h5").string()};
  const Plan simulated = plan();
  run_stage(simulated, simulated.node(Stage::target, {}));
  std::filesystem::copy(simulated.node(Stage::target, {}).path, folder_ / "r.h5");
  const Plan p = plan(recorded);
  const Node& node = p.node(Stage::policy_test, {"Point", 1, 0, 0});
  run_stage(p, node);
  const PolicyTest test = kPolicyTestSchema.read(node);
  EXPECT_FALSE(test.target);
  ASSERT_TRUE(test.grid);
  const Plan without = plan({recorded.front(), "policy.grid={}"});
  EXPECT_THROW(without.node(Stage::policy_test, {"Point", 1, 0, 0}), InputError);
}

}  // namespace
}  // namespace npdr::pipeline
