#include "pipeline/plan/plan.h"
#include "pipeline/plan/shards.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/error.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/config/rollout_check.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/plan/key_parts.h"
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

TEST(Plan, EveryNodeComesAfterWhatItNeeds) {
  const Plan plan = plan_of();
  for (std::size_t i = 0; i < plan.nodes.size(); ++i) {
    for (const std::size_t need : plan.nodes[i].needs) EXPECT_LT(need, i);
  }
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

TEST(Plan, ALimitOfFailuresIsPartOfTheReportsKeyAlone) {
  const Plan before = plan_of();
  const Plan after = plan_of({"limits.max_failed_fraction=0.5"});
  ASSERT_EQ(after.nodes.size(), before.nodes.size());
  for (std::size_t i = 0; i < after.nodes.size(); ++i) {
    EXPECT_EQ(after.nodes[i].key != before.nodes[i].key, after.nodes[i].stage == Stage::report);
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

// The keys of `stages` differ between the plans, and no others.
void expect_only_differ(const Plan& a, const Plan& b, const std::set<Stage>& stages) {
  for (const Stage stage : {Stage::target, Stage::held_out, Stage::propose, Stage::simulate,
                            Stage::infer, Stage::baseline, Stage::evaluate, Stage::report}) {
    EXPECT_EQ(keys(a, stage) != keys(b, stage), stages.contains(stage)) << name_of(stage);
  }
}

TEST(Plan, HeldOutRolloutsAreForBaselinesAndEvaluations) {
  const std::set<Stage> judged = {Stage::held_out, Stage::baseline, Stage::evaluate, Stage::report};
  expect_only_differ(plan_of(), plan_of({"target.held_out=1"}), judged);
  expect_only_differ(plan_of({"target.held_out=2"}), plan_of({"target.held_out=1"}), judged);
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

TEST(Plan, ReferencesAreForBaselinesAndEvaluations) {
  const std::set<Stage> judged = {Stage::baseline, Stage::evaluate, Stage::report};
  const std::string name = "reference=[{name='measured'";
  const Plan measured = plan_of({name + ", parameters={pole_mass=1.1}}]"});
  expect_only_differ(plan_of(), measured, judged);
  expect_only_differ(measured, plan_of({name + ", parameters={pole_mass=1.2}}]"}), judged);
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

TEST(Plan, SegmentsDontChangeASimulatedTarget) {
  const Plan before = plan_of();
  const Plan segments = plan_of({"simulator.segment_length=50"});
  EXPECT_EQ(keys(segments, Stage::target), keys(before, Stage::target));
  EXPECT_NE(keys(segments, Stage::simulate), keys(before, Stage::simulate));
  EXPECT_NE(keys(segments, Stage::baseline), keys(before, Stage::baseline));
}

// A recording of the pendulum whose states are all 1: 2 rollouts of 40 steps.
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
}

TEST(Plan, ChecksOfTheObservationAloneNeedNoCalibration) {
  const Plan plan = plan_of({"diagnose.checks=['ood', 'predictive', 'training']"});
  EXPECT_EQ(count(plan, Stage::diagnose), 4);
  EXPECT_EQ(count(plan, Stage::simulate), count(plan_of(), Stage::simulate));
}

TEST(Plan, TheLevelOfTheChecksIsTheReportsAlone) {
  const Plan one = plan_of({"diagnose={}"}), other = plan_of({"diagnose={ alpha = 0.1 }"});
  EXPECT_EQ(one.node(Stage::diagnose, {"A", 1, 0}).key,
            other.node(Stage::diagnose, {"A", 1, 0}).key);
  EXPECT_NE(one.node(Stage::report, {}).key, other.node(Stage::report, {}).key);
}

TEST(Plan, ASelectionLeavesOutTheRest) {
  const Plan plan = plan_of({}, {{"B"}, {2}});
  EXPECT_EQ(keys(plan, Stage::infer).size(), 1u);
  EXPECT_THROW(plan_of({}, {{"C"}, {}}), InputError);
  EXPECT_THROW(plan_of({}, {{}, {3}}), InputError);
}

// Everything that a study says of a program's parameters and goal changes rows, or what they are
// judged by.
TEST(Plan, WhatAStudySaysOfItsProgramIsInTheKeys) {
  const StudyText text =
      StudyText("spring")
          .with("target", {"truth = { a = 1.0 }"})
          .with("simulator", {"worker = \"true\"", "states = [\"q\"]", "dt = 0.1", "num_steps = 9",
                              "initial_states = [[0.0]]",
                              "parameter = [{ name = \"a\", nominal = 1.0 }, { name = \"b\", "
                              "nominal = 2.0, lower = 0.0, upper = 3.0, unit = \"m\" }]",
                              "goal = { place = { q = 0.0 }, radius = 0.1 }"})
          .with("evaluate", {"metrics = [\"rmse\", \"goal\"]"})
          .with("prior", {"a = { uniform = [0.0, 2.0] }"})
          .method("A", {"num_simulations = 100"});
  const auto plan = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    return make_plan(parse_study(changed, "s.toml"), WorkFolder("runs"));
  };
  const Plan before = plan("dt", "dt");
  for (const auto& [from, to] :
       {std::pair("nominal = 2.0", "nominal = 2.5"), std::pair("lower = 0.0", "lower = 0.1"),
        std::pair("upper = 3.0", "upper = 4.0")}) {
    EXPECT_NE(keys(plan(from, to), Stage::simulate), keys(before, Stage::simulate)) << to;
    EXPECT_NE(keys(plan(from, to), Stage::target), keys(before, Stage::target)) << to;
  }
  EXPECT_EQ(keys(plan("unit = \"m\"", "unit = \"cm\""), Stage::simulate),
            keys(before, Stage::simulate));
  for (const auto& [from, to] :
       {std::pair("radius = 0.1", "radius = 0.2"), std::pair("q = 0.0", "q = 0.5")}) {
    const Plan after = plan(from, to);
    EXPECT_EQ(keys(after, Stage::simulate), keys(before, Stage::simulate)) << to;
    EXPECT_NE(keys(after, Stage::evaluate), keys(before, Stage::evaluate)) << to;
    EXPECT_NE(keys(after, Stage::baseline), keys(before, Stage::baseline)) << to;
  }
}

TEST(Plan, NodesAreFoundByTheBeginningOfTheirKey) {
  const Plan plan = plan_of();
  const Node& node = plan.nodes[3];
  EXPECT_EQ(&plan.node_by_key(node.key.substr(0, 12)), &node);
  EXPECT_THROW(plan.node_by_key("x"), InputError);
  EXPECT_THROW(plan.node_by_key(""), InputError);  // all begin like this
}

// A study that asks for nothing new keeps what was computed before: the report's key is made of all
// others.
// A pin for each stage: a new field re-pins those that it affects. The report's key holds the whole
// study, and changes with each.
TEST(Plan, KeysOfEachStageStay) {
  using Pins = std::map<Stage, std::string>;
  const auto expect_pins = [](const std::vector<std::string>& overrides, const Pins& pins) {
    const Plan plan = plan_of(overrides);
    for (const auto& [stage, key] : pins) EXPECT_EQ(last_key(plan, stage), key) << name_of(stage);
  };
  expect_pins({"diagnose={}"}, {{Stage::target, "1cc7a0831e756f45518e9c0436612c28"},
                                {Stage::propose, "e613be47d54d732a656955870962f1b1"},
                                {Stage::simulate, "baa1cecaf3eea7e3132a80e83b9f9247"},
                                {Stage::infer, "bf75625ff34e6b3b92c067884b7016cf"},
                                {Stage::evaluate, "727e493565ae973b1bbd03eddbf0edc4"},
                                {Stage::diagnose, "b120a37c5540b8b26c19b8d6a7c64be1"},
                                {Stage::baseline, "f397a16268d7e4099b5e11af7ed7d6c0"}});
  expect_pins({"target.held_out=1"}, {{Stage::held_out, "385d37349fa6f0fc8d3d23eb1ba8644b"}});
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
  const Node& infer = first.node(Stage::infer, {"R", 1, 1});
  EXPECT_EQ(inputs_of(first, infer), std::vector<Stage>{Stage::target});
  const auto key = [&](const std::string& assignment) {
    return plan({assignment}).node(Stage::infer, {"R", 1, 1}).key;
  };
  EXPECT_NE(key("simulator.parameters={ gravity = 9.7 }"), infer.key);
  EXPECT_NE(key("prior.pole_mass={ uniform = [0.01, 0.04] }"), infer.key);
  EXPECT_NE(key("method.linear_regression.window=7"), infer.key);
  EXPECT_EQ(key("observation_noise.scale=0.3"), infer.key);
  EXPECT_EQ(key("method.num_rounds=4"), infer.key);
}

}  // namespace
}  // namespace npdr::pipeline
