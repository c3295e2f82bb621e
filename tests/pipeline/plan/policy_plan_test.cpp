// Plans of studies with policies, and on recordings.

#include "core/error.h"
#include "pipeline/config/study_check.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/run/scheduler.h"
#include "tests/pipeline/plan/plan_parts.h"
#include "tests/pipeline/standing_recording.h"
#include "tests/study_text.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

StudyText two_posteriors(const StudyText::Lines& loop) {
  StudyText::Lines online = {"num_simulations = 100"};
  online.insert(online.end(), loop.begin(), loop.end());
  return furuta_study("loop")
      .with("study", {"seeds = [1, 2]"})
      .with("target", {"truth = { pole_mass = 0.02 }", "num_rollouts = 2"})
      .method("once", {"num_simulations = 100"})
      .method("online", online);
}

std::string loop_text() {
  return two_posteriors({"num_iterations = 3", "policy_iterations = 1"})
      .method("randomized", {"algorithm = \"prior\""})
      .method("nominal", {"algorithm = \"nominal\""})
      .with("policy", {});
}

Plan loop_of(const std::vector<std::string>& overrides = {}) {
  return make_plan(parse_study(loop_text(), "loop.toml", overrides), WorkFolder("runs"));
}

TEST(PolicyPlan, EveryMethodSearchesAndIsTestedBeforeAndAfter) {
  const Plan plan = loop_of();
  EXPECT_EQ(count(plan, Stage::policy), 2 * (1 + 3 + 1 + 1));
  EXPECT_EQ(count(plan, Stage::policy_test), 2 * (1 + 4)) << "that before is everybody's";
  EXPECT_EQ(count(plan, Stage::infer), 2 * 3)
      << "two methods infer nothing, two share their first posterior";
  EXPECT_EQ(count(plan, Stage::evaluate), 2 * 2);
  const Node& search = plan.node(Stage::policy, {"once", 1, 0, 1});
  EXPECT_EQ(inputs_of(plan, search), std::vector<Stage>{Stage::infer});
  EXPECT_TRUE(inputs_of(plan, plan.node(Stage::policy, {"randomized", 1, 0, 1})).empty());
  const Node& before = plan.node(Stage::policy_test, {"nominal", 2, 0, 0});
  EXPECT_EQ(&before, &plan.node(Stage::policy_test, {"online", 2, 0, 0}));
  EXPECT_EQ(before.label(), "policy_test once, seed 2, before any search");
  EXPECT_EQ(inputs_of(plan, plan.node(Stage::policy_test, {"online", 2, 0, 3})),
            std::vector<Stage>{Stage::policy});
  EXPECT_EQ(traits_of(Stage::policy_test).program, "npdr-policy");
}

TEST(PolicyPlan, LaterIterationsInferFromWhatThePolicyCollects) {
  const Plan plan = loop_of();
  const Node& collection = plan.node(Stage::target, {"online", 1, 0, 2});
  EXPECT_EQ(inputs_of(plan, collection), (std::vector<Stage>{Stage::target, Stage::policy}));
  EXPECT_EQ(plan.find_input(collection, "target"), &plan.node(Stage::target, {}));
  EXPECT_EQ(collection.label(), "target online, seed 1, iteration 2");
  EXPECT_EQ(link_of(plan, collection, collection.uses.front()),
            "runs/loop/online/seed-1/iteration-2/target.h5");
  const Node& infer = plan.node(Stage::infer, {"online", 1, 1, 2});
  EXPECT_EQ(plan.find_input(infer, "target"), &collection);
  const Node& search = plan.node(Stage::policy, {"online", 1, 0, 2});
  EXPECT_EQ(inputs_of(plan, search), (std::vector<Stage>{Stage::infer, Stage::policy}));
  EXPECT_NE(plan.node(Stage::propose, {"online", 1, 1, 2}).key,
            plan.node(Stage::propose, {"online", 1, 1, 1}).key)
      << "fresh draws of the prior";
  // The last posterior is measured by what all methods have seen.
  const Node& evaluation = plan.node(Stage::evaluate, {"online", 1, 1, 3});
  EXPECT_EQ(plan.find_input(evaluation, "target"), &plan.node(Stage::target, {}));
  EXPECT_EQ(plan.find_input(evaluation, "posterior"),
            &plan.node(Stage::infer, {"online", 1, 1, 3}));
}

TEST(PolicyPlan, AFirstIterationSharesWhatAStudyWithoutPoliciesHasMade) {
  const Plan plan = loop_of();
  const Plan without =
      make_plan(parse_study(std::string(two_posteriors({})), "loop.toml"), WorkFolder("runs"));
  EXPECT_EQ(without.node(Stage::infer, {"online", 1, 1}).key,
            plan.node(Stage::infer, {"online", 1, 1, 1}).key);
  EXPECT_EQ(&plan.node(Stage::simulate, {"online", 1, 1, 1}),
            &plan.node(Stage::simulate, {"once", 1, 1}));
}

TEST(PolicyPlan, OnlyWhatDependsOnAKeyChangesWithIt) {
  const Plan before = loop_of();
  const auto differ = [&](const std::string& assignment, Stage stage) {
    return keys(loop_of({assignment}), stage) != keys(before, stage);
  };
  EXPECT_TRUE(differ("policy.population=7", Stage::policy));
  EXPECT_FALSE(differ("policy.elite_fraction=0.5", Stage::policy)) << "another optimizer's";
  EXPECT_TRUE(differ("policy.num_steps=500", Stage::policy));
  EXPECT_TRUE(differ("method.policy_iterations=7", Stage::policy));
  for (const char* test : {"policy.num_test_states=30",
                           "policy.grid={ x = { parameter = 'pole_mass', range = [0.01, 0.03] }, y "
                           "= { parameter = 'gravity', values = [9.0, 9.8] } }"}) {
    EXPECT_FALSE(differ(test, Stage::policy)) << test;
    EXPECT_TRUE(differ(test, Stage::policy_test)) << test;
    EXPECT_TRUE(differ(test, Stage::report)) << test;
  }
  // The first iteration's posterior is made before any policy; the later ones' follow from them.
  const Plan other = loop_of({"policy.population=7"});
  EXPECT_EQ(other.node(Stage::infer, {"online", 1, 1, 1}).key,
            before.node(Stage::infer, {"online", 1, 1, 1}).key);
  EXPECT_NE(other.node(Stage::infer, {"online", 1, 1, 2}).key,
            before.node(Stage::infer, {"online", 1, 1, 2}).key);
}

TEST(PolicyPlan, MoreIterationsKeepWhatIsThere) {
  const Plan before = loop_of(), after = loop_of({"method.online.num_iterations=4"});
  for (const std::string& key : keys(before, Stage::policy)) {
    EXPECT_EQ(keys(after, Stage::policy).count(key), 1u);
  }
}

TEST(PolicyPlan, EachRoundOfEachIterationHasItsOwnRandomNumbersAndRollouts) {
  std::set<std::uint64_t> rounds;
  for (const Index iteration : {1, 2, 3}) {
    for (const Index round : {0, 1, 2}) rounds.insert(Use{"A", 1, round, iteration}.stream_round());
  }
  EXPECT_EQ(rounds.size(), 9u);
  EXPECT_EQ((Use{"A", 1, 2, 1}.stream_round()), 2u);
  EXPECT_EQ((Use{"A", 1, 2}.stream_round()), 2u);
  MethodConfig method;
  EXPECT_EQ(num_rollouts_seen(method, {"A", 1, 1, 3}), 0) << "all";
  method.num_rollouts = 2;
  EXPECT_EQ(num_rollouts_seen(method, {"A", 1, 1}), 2);
  EXPECT_EQ(num_rollouts_seen(method, {"A", 1, 1, 3}), 6);
}

// Later parts of the loop can be asked for without the report.
TEST(PolicyPlan, StagesUntilInferenceReachTheLaterIterations) {
  const Plan plan = loop_of();
  const auto has = [&](Stage until, Stage stage, const Use& use) {
    const auto missing = missing_nodes(plan, until);
    return std::ranges::find(missing, &plan.node(stage, use)) != missing.end();
  };
  EXPECT_TRUE(has(Stage::infer, Stage::infer, {"online", 1, 1, 3}));
  EXPECT_TRUE(has(Stage::evaluate, Stage::evaluate, {"online", 1, 1, 3}));
  EXPECT_FALSE(has(Stage::infer, Stage::policy, {"online", 1, 0, 3})) << "nobody needs it";
  EXPECT_FALSE(has(Stage::simulate, Stage::simulate, {"online", 1, 1, 2}));
}

// It shows of the target whatever else there is.
TEST(PolicyPlan, TheReportNeedsTheTargetAlsoWhereNothingIsInferred) {
  const Plan plan = make_plan(parse_study(loop_text(), "loop.toml"), WorkFolder("runs"),
                              {{"randomized", "nominal"}, {}});
  const std::vector<Stage> inputs = inputs_of(plan, plan.nodes.back());
  EXPECT_EQ(std::ranges::count(inputs, Stage::target), 1);
}

// Messages are in tests/golden/config.txt.
class RecordingPlan : public FolderTest {
 protected:
  RecordingPlan() { write_standing(folder_ / "r.h5"); }

  Plan plan(std::vector<std::string> overrides) const {
    overrides.push_back("target.recording=" + (folder_ / "r.h5").string());
    return plan_of(overrides);
  }
};

TEST_F(RecordingPlan, HasAFloorAndTheRolloutsThatTheStudyPicks) {
  const std::string without = "evaluate.floor=false";
  EXPECT_EQ(keys(plan_of({without}), Stage::baseline), keys(plan_of(), Stage::baseline));
  EXPECT_NE(keys(plan({without}), Stage::baseline), keys(plan({}), Stage::baseline));
  EXPECT_EQ(names_of(plan({"target.rollouts=[2, 1]"}).target), "secondfirst");
}

TEST_F(RecordingPlan, AChannelThatIsZeroThroughoutIsNamed) {
  Plan still = plan({});
  EXPECT_NO_THROW(require_motion(still.study, still.target));
  RowMatrix& states = still.target.rollouts[1].states;
  states.col(1).head(40).setZero();  // but for the last, which isn't replayed
  EXPECT_TRUE(says(problem([&] { require_motion(still.study, still.target); }),
                   {"--set target.recording=", "channel 'theta_dot' of rollout 'second' is 0",
                    "leave out the rollout (target.rollouts)"}));
  states.col(1).setZero();
  states(0, 1) = 1.0;  // the first one, of which there is no noise
  EXPECT_THROW(require_motion(still.study, still.target), InputError);
}

}  // namespace
}  // namespace npdr::pipeline
