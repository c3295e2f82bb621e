#include "pipeline/plan/plan.h"

#include <gtest/gtest.h>

#include <set>

#include "core/error.h"
#include "pipeline/config/study_reader.h"

namespace npdr::pipeline {
namespace {

constexpr const char* kStudy = R"toml(
[study]
name = "two"
seeds = [1, 2]
[target]
truth = {}
[simulator]
name = "pendulum"
[prior]
pole_mass = { uniform = [0.3, 1.7] }
[[method]]
name = "A"
num_rounds = 2
num_simulations = 100
embedding = { kind = "bayessim" }
[[method]]
name = "B"
num_rounds = 1
num_simulations = 100
embedding = { kind = "bayessim" }
density_estimator = { kind = "mdn" }
)toml";

Plan plan_of(const std::vector<std::string>& overrides = {}, const Selection& selection = {}) {
  return make_plan(parse_study(kStudy, "two.toml", overrides), WorkFolder("runs"), selection);
}

std::set<std::string> keys(const Plan& plan, Stage stage) {
  std::set<std::string> found;
  for (const Node& node : plan.nodes) {
    if (node.stage == stage) found.insert(node.key);
  }
  return found;
}

TEST(Plan, EveryNodeComesAfterWhatItNeeds) {
  const Plan plan = plan_of();
  for (std::size_t i = 0; i < plan.nodes.size(); ++i) {
    for (const std::size_t need : plan.nodes[i].needs) EXPECT_LT(need, i);
  }
}

TEST(Plan, MethodsShareTheFirstRoundsSimulations) {
  const Plan plan = plan_of();
  EXPECT_EQ(&plan.node(Stage::simulate, {"A", 1, 1}), &plan.node(Stage::simulate, {"B", 1, 1}));
  EXPECT_NE(plan.node(Stage::infer, {"A", 1, 1}).key, plan.node(Stage::infer, {"B", 1, 1}).key);
  EXPECT_EQ(keys(plan, Stage::simulate).size(), 4u);  // per seed: round 1 of both, round 2 of A
}

TEST(Plan, KeysAreTheSameEveryTime) {
  const Plan first = plan_of();
  const Plan second = plan_of();
  ASSERT_EQ(first.nodes.size(), second.nodes.size());
  for (std::size_t i = 0; i < first.nodes.size(); ++i) {
    EXPECT_EQ(first.nodes[i].key, second.nodes[i].key);
  }
}

TEST(Plan, OnlyWhatDependsOnAKeyChangesWithIt) {
  const Plan before = plan_of();
  const Plan learning_rate = plan_of({"method.A.training.learning_rate=0.1"});
  EXPECT_EQ(learning_rate.node(Stage::simulate, {"A", 1, 1}).key,
            before.node(Stage::simulate, {"A", 1, 1}).key);
  EXPECT_NE(learning_rate.node(Stage::infer, {"A", 1, 1}).key,
            before.node(Stage::infer, {"A", 1, 1}).key);
  EXPECT_EQ(learning_rate.node(Stage::infer, {"B", 1, 1}).key,
            before.node(Stage::infer, {"B", 1, 1}).key);

  const Plan simulator = plan_of({"simulator.substeps=2"});
  EXPECT_EQ(keys(simulator, Stage::propose).count(before.node(Stage::propose, {"A", 1, 1}).key),
            1u);
  EXPECT_NE(simulator.node(Stage::simulate, {"A", 1, 1}).key,
            before.node(Stage::simulate, {"A", 1, 1}).key);
}

TEST(Plan, MoreRoundsAndAnotherShardSizeKeepWhatIsThere) {
  const Plan before = plan_of();
  const Plan after = plan_of({"method.A.num_rounds=3", "simulate.shard_size=7"});
  EXPECT_EQ(after.node(Stage::infer, {"A", 2, 2}).key, before.node(Stage::infer, {"A", 2, 2}).key);
  EXPECT_EQ(shards(after, after.node(Stage::simulate, {"A", 1, 1})).size(), 15u);
}

TEST(Plan, ASelectionLeavesOutTheRest) {
  const Plan plan = plan_of({}, {{"B"}, {2}, {}});
  EXPECT_EQ(keys(plan, Stage::infer).size(), 1u);
  EXPECT_THROW(plan_of({}, {{"C"}, {}, {}}), InputError);
  EXPECT_THROW(plan_of({}, {{}, {3}, {}}), InputError);
}

TEST(Plan, NodesAreFoundByTheBeginningOfTheirKey) {
  const Plan plan = plan_of();
  const Node& node = plan.nodes[3];
  EXPECT_EQ(&plan.node_by_key(node.key.substr(0, 12)), &node);
  EXPECT_THROW(plan.node_by_key("x"), InputError);
  EXPECT_THROW(plan.node_by_key(""), InputError);  // all begin like this
}

}  // namespace
}  // namespace npdr::pipeline
