#include "pipeline/plan/plan.h"

#include <algorithm>
#include <set>

#include "core/error.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/plan/plan_builder.h"
#include "tests/pipeline/plan/plan_parts.h"
#include "tests/pipeline/small_study.h"
#include "tests/study_text.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

TEST(Plan, HasALimit) {
  const std::vector<std::string> rounds = {"method.A.num_rounds=51", "method.B.num_rounds=50"};
  std::string seeds = "study.seeds=[1";
  for (int seed = 2; seed <= 50; ++seed) seeds += "," + std::to_string(seed);
  seeds += "]";
  EXPECT_TRUE(says(message_of<InputError>([&] {
                     plan_of({rounds[0], rounds[1], seeds});
                   }),
                   {"two: its seeds, methods, iterations, rounds and folds ask for 5050 inferences",
                    "must be at most 5000; lower method.num_rounds"}));
  EXPECT_NO_THROW(plan_of({rounds[0], rounds[1], seeds}, {{}, {1}}));
}

// It reads them, and they may be gone while the evaluations that were made of them are there.
TEST(Plan, TheReportNeedsWhatItsEvaluationsNeed) {
  const Plan plan = plan_of();
  const std::vector<std::size_t>& needs = plan.node(Stage::report, {}).needs;
  for (const Node& node : plan.nodes) {
    if (node.stage != Stage::evaluate) continue;
    for (const std::size_t need : node.needs) {
      EXPECT_EQ(std::ranges::count(needs, need), 1) << plan.nodes[need].label();
    }
  }
}

TEST(Plan, MethodsShareTheFirstRoundsSimulations) {
  const Plan plan = plan_of();
  EXPECT_EQ(&plan.node(Stage::simulate, {"A", 1, 1}), &plan.node(Stage::simulate, {"B", 1, 1}));
  EXPECT_NE(plan.node(Stage::infer, {"A", 1, 1}).key, plan.node(Stage::infer, {"B", 1, 1}).key);
  EXPECT_EQ(keys(plan, Stage::simulate).size(), 4u);  // per seed: round 1 of both, round 2 of A
}

TEST(Plan, WhatMethodsShareIsListedOnceInTheReportsNeeds) {
  const Plan plan = plan_of({"method.A.num_rounds=1", "method.A.algorithm=npe_nle",
                             "method.A.density_estimator={kind='mdn'}"});
  EXPECT_EQ(&plan.node(Stage::evaluate, {"A", 1, 1}), &plan.node(Stage::evaluate, {"B", 1, 1}));
  const Node& report = plan.node(Stage::report, {});
  EXPECT_EQ(plan.inputs(report, "evaluation").size(), 2u);  // one per seed
  EXPECT_EQ(report.identity.inputs.size(), 3u);
}

// The keys of `stages` differ between the plans, and no others.
void expect_only_differ(const Plan& a, const Plan& b, const std::set<Stage>& stages) {
  for (const Stage stage : {Stage::target, Stage::held_out, Stage::propose, Stage::simulate,
                            Stage::infer, Stage::baseline, Stage::evaluate, Stage::report}) {
    EXPECT_EQ(keys(a, stage) != keys(b, stage), stages.contains(stage)) << name_of(stage);
  }
}

TEST(Plan, WhatASettingMeansNothingToKeepsItsKeys) {
  using enum Stage;
  const std::string name = "reference=[{name='measured'";
  const std::string two = "target.held_out=2";
  const std::string measured = name + ", parameters={pole_mass=1.1}}]";
  struct Case {
    std::vector<std::string> before, after;
    std::set<Stage> stages;
  };
  const std::vector<Case> cases = {
      {{}, {"limits.max_failed_fraction=0.5"}, {report}},
      {{}, {"simulator.segment_length=50"}, {propose, simulate, infer, baseline, evaluate, report}},
      {{}, {two}, {held_out, baseline, evaluate, report}},
      {{two}, {"target.held_out=1"}, {held_out, baseline, evaluate, report}},
      {{}, {measured}, {baseline, evaluate, report}},
      {{measured}, {name + ", parameters={pole_mass=1.2}}]"}, {baseline, evaluate, report}}};
  for (const auto& [before, after, stages] : cases) {
    SCOPED_TRACE(after.front());
    expect_only_differ(plan_of(before), plan_of(after), stages);
  }
}

TEST(Plan, FilesMayLieAnywhereAsSeenFromTheCurrentFolder) {
  Study study = parse_study(kStudyText, "s.toml");
  study.target.recording = "a/recording.h5";
  const auto here = study_document(study);
  study.target.recording = "../b/recording.h5";
  const auto elsewhere = study_document(study);
  EXPECT_NE(elsewhere, here) << "artefacts know where they are from";
  EXPECT_EQ(without_folders(elsewhere), without_folders(here));
  study.target.recording = "a/other.h5";
  EXPECT_NE(without_folders(study_document(study)), without_folders(here));
}

TEST(Plan, OnlyWhatDependsOnAKeyChangesWithIt) {
  const Plan before = plan_of();
  const auto is_same = [&](const Plan& plan, Stage stage, const Use& use) {
    return plan.node(stage, use).key == before.node(stage, use).key;
  };
  const Plan learning_rate = plan_of({"method.A.training.learning_rate=0.1"});
  EXPECT_TRUE(is_same(learning_rate, Stage::simulate, {"A", 1, 1}));
  EXPECT_FALSE(is_same(learning_rate, Stage::infer, {"A", 1, 1}));
  EXPECT_TRUE(is_same(learning_rate, Stage::infer, {"B", 1, 1}));
  const Plan simulator = plan_of({"simulator.substeps=2"});
  EXPECT_TRUE(is_same(simulator, Stage::propose, {"A", 1, 1}));
  EXPECT_FALSE(is_same(simulator, Stage::simulate, {"A", 1, 1}));
  const Plan more = plan_of({"method.A.num_rounds=3", "simulate.shard_size=7"});
  EXPECT_TRUE(is_same(more, Stage::infer, {"A", 2, 2}));
  EXPECT_EQ(shards(more, more.node(Stage::simulate, {"A", 1, 1})).size(), 15u);
}

TEST(Plan, EveryMethodIsRepeatedWithoutEachFold) {
  const Plan whole = plan_of(), folded = plan_of({"evaluate.leave_out=2"});
  EXPECT_EQ(count(folded, Stage::target), 3);
  EXPECT_EQ(count(folded, Stage::held_out), 2);
  EXPECT_EQ(count(folded, Stage::infer), 3 * count(whole, Stage::infer));
  EXPECT_EQ(count(folded, Stage::evaluate), 3 * count(whole, Stage::evaluate));
  for (const Node& node : whole.nodes) {
    if (node.stage == Stage::report) continue;
    EXPECT_NO_THROW(folded.node_by_key(node.key)) << node.label();
  }
  const Use use{.method = "A", .seed = 2, .round = 2, .fold = 1};
  const Node& evaluation = folded.node(Stage::evaluate, use);
  const Use fold{.fold = 1};
  EXPECT_EQ(folded.find_input(evaluation, "target"), &folded.node(Stage::target, fold));
  EXPECT_EQ(folded.find_input(evaluation, "held_out"), &folded.node(Stage::held_out, fold));
  EXPECT_EQ(evaluation.label(), "evaluate A, seed 2, round 2, without fold 1");
  EXPECT_EQ(link_of(folded, evaluation, use),
            "runs/two/a/seed-2/without-fold-1/round-2/evaluate.h5");
}

TEST(Plan, FoldsTakeTurns) {
  const Study study = parse_study(std::string(two_methods()), "two.toml", {"evaluate.leave_out=2"});
  Target target;
  for (const char* name : {"a", "b", "c", "d", "e"}) target.rollouts.push_back({name, {}, {}});
  EXPECT_EQ(names_of(of_fold(study, target, 1)), "ace");
  EXPECT_EQ(names_of(without_fold(study, target, 1)), "bd");
  EXPECT_EQ(names_of(of_fold(study, target, 2)), "bd");
  EXPECT_EQ(names_of(without_fold(study, target, 2)), "ace");
  EXPECT_EQ(names_of(without_fold(study, target, 0)), "abcde");
}

TEST(Plan, SettingsOfAnotherSimulatorAreInNoKey) {
  const auto document = [](const Plan& plan) {
    return plan.node(Stage::simulate, {"A", 1, 1}).identity.key_document.dump();
  };
  EXPECT_FALSE(has(document(plan_of()), "minigolf"));
  const Plan golf =
      plan_of({"simulator.name=minigolf", "prior={ball_radius={uniform=[0.01,0.03]}}"});
  EXPECT_TRUE(has(document(golf), "solver_erp"));
  EXPECT_FALSE(has(document(golf), "integrator"));
}

TEST(Plan, MethodsShareTheSimulationsOfCalibration) {
  const Plan without = plan_of(), with = plan_of({"diagnose={}"});
  EXPECT_EQ(count(without, Stage::diagnose), 0);
  EXPECT_EQ(count(with, Stage::diagnose), 4);  // two methods, two seeds
  // One a seed more than without.
  EXPECT_EQ(count(with, Stage::simulate), count(without, Stage::simulate) + 2);
  const Node& simulation = with.node(Stage::simulate, {"A", 1, 0});
  EXPECT_EQ(&simulation, &with.node(Stage::simulate, {"B", 1, 0}));
  EXPECT_TRUE(is_calibration(simulation));
  EXPECT_EQ(num_rows(with, simulation), 300);
  EXPECT_EQ(simulation.label(), "simulate A, seed 1, calibration");
  EXPECT_EQ(link_of(with, simulation, simulation.uses.front()),
            "runs/two/a/seed-1/calibration/simulate.h5");
  const Plan of_x_o = plan_of({"diagnose.checks=['ood', 'predictive', 'training']"});
  EXPECT_EQ(count(of_x_o, Stage::diagnose), 4);
  EXPECT_EQ(count(of_x_o, Stage::simulate), count(without, Stage::simulate));
  const Plan level = plan_of({"diagnose={ alpha = 0.1 }"});
  EXPECT_EQ(keys(level, Stage::diagnose), keys(with, Stage::diagnose));
  EXPECT_NE(keys(level, Stage::report), keys(with, Stage::report));
}

TEST(Plan, ASelectionLeavesOutTheRest) {
  EXPECT_EQ(keys(plan_of({}, {{"B"}, {2}}), Stage::infer).size(), 1u);
  EXPECT_THROW(plan_of({}, {{"C"}, {}}), InputError);
  EXPECT_THROW(plan_of({}, {{}, {3}}), InputError);
  const Plan plan = plan_of();
  const Node& node = plan.nodes[3];
  EXPECT_EQ(&plan.node_by_key(node.key.substr(0, 12)), &node);
  EXPECT_THROW(plan.node_by_key("x"), InputError);
  EXPECT_THROW(plan.node_by_key(""), InputError);  // all begin like this
}

// The last round's posterior holds all that a population needs of the rounds before it.
TEST(Plan, APopulationNeedsTheLastRoundAlone) {
  const Plan plan = plan_of({"method.\"A\".algorithm=abc_smc", "method.\"A\".num_rounds=3"});
  const Node& third = plan.node(Stage::infer, {"A", 1, 3});
  EXPECT_EQ(inputs_of(plan, third),
            (std::vector<Stage>{Stage::target, Stage::simulate, Stage::infer}));
  EXPECT_EQ(plan.find_input(third, "posterior_2"), &plan.node(Stage::infer, {"A", 1, 2}));
  EXPECT_EQ(plan.find_input(third, "simulation_3"), &plan.node(Stage::simulate, {"A", 1, 3}));
}

TEST(Plan, PosteriorsDependOnTheSettingsOfTheirOwnFamily) {
  const auto key = [](const char* method, const std::vector<std::string>& overrides) {
    std::vector<std::string> all = {"method.\"A\".algorithm=abc_smc"};
    all.insert(all.end(), overrides.begin(), overrides.end());
    return plan_of(all).node(Stage::infer, {method, 1, 1}).key;
  };
  for (const char* abc : {"method.abc.quantile=0.3", "method.abc.distance=rmse"}) {
    EXPECT_NE(key("A", {abc}), key("A", {})) << abc;
    EXPECT_EQ(key("B", {abc}), key("B", {})) << abc;
  }
  EXPECT_EQ(key("A", {"method.training.learning_rate=0.1"}), key("A", {}));
  EXPECT_NE(key("B", {"method.training.learning_rate=0.1"}), key("B", {}));
}

TEST(Plan, ARegressionNeedsTheTargetAlone) {
  const std::string text = furuta_study("r").method("R", {"algorithm = \"linear_regression\""});
  const auto plan = [&](const std::vector<std::string>& overrides) {
    return make_plan(parse_study(text, "r.toml", overrides), WorkFolder("runs"));
  };
  const Plan first = plan({});
  EXPECT_EQ(first.nodes.size(), 5u) << "target, infer, evaluate, baseline, report";
  EXPECT_EQ(inputs_of(first, first.node(Stage::infer, {"R", 1, 1})),
            std::vector<Stage>{Stage::target});
  for (const auto& [setting, changes] : {std::pair{"simulator.parameters={ gravity = 9.7 }", true},
                                         {"prior.pole_mass={ uniform = [0.01, 0.04] }", true},
                                         {"method.linear_regression.window=7", true},
                                         {"observation_noise.scale=0.3", false},
                                         {"method.num_rounds=4", false}}) {
    EXPECT_EQ(keys(plan({setting}), Stage::infer) != keys(first, Stage::infer), changes) << setting;
  }
}

}  // namespace
}  // namespace npdr::pipeline
