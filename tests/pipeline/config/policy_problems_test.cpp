// Problems of [policy] and what belongs to it: place, value and what is allowed are what users must
// be told.
#include "tests/pipeline/small_study.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

const std::string kNpe = "num_simulations = 200";

// Ends in the table [policy], whose first line is the twelfth.
const std::string kPolicyText =
    edited(furuta_study("small").only("target", {"truth = {}"}).method("A").with("policy", {}),
           "[diagnose]\nchecks = []\n", "");

std::string policy_problems(const std::string& more) { return problems_of(kPolicyText + more); }

TEST(PolicyProblems, APolicyNeedsATask) {
  EXPECT_EQ(policy_problems(""), "");
  EXPECT_TRUE(says(problems_of(std::string(kStudyText) + "[policy]\n"),
                   {"s.toml:22:1: policy", "simulator.name = 'furuta'", "found 'pendulum'"}));
}

TEST(PolicyProblems, SettingsOfASearchAreChecked) {
  EXPECT_TRUE(says(policy_problems("optimizer = 'powr'"),
                   {"s.toml:12:13: policy.optimizer = 'powr'",
                    "must be one of power, cross_entropy", "'power'"}));
  const std::string wrong = edited(kPolicyText, "[policy]", "[policy]\noptimizer = 'cem'");
  EXPECT_TRUE(
      says(problems_of(edited(wrong, "name = \"A\"", "name = 'A'\npolicy_iterations = 3")),
           {"s.toml:13:13: policy.optimizer = 'cem'", "must be one of power, cross_entropy"}))
      << "and nothing about the method";
  EXPECT_TRUE(says(policy_problems("population = 1"),
                   {"s.toml:12:14: policy.population = 1", "must be >= 2 and <= 100000"}));
  EXPECT_TRUE(says(policy_problems("num_test_states = 19"),
                   {"s.toml:12:19: policy.num_test_states = 19", "must be >= 20 and <= 1000000"}));
  EXPECT_TRUE(says(policy_problems("initial = { energy_gains = 3 }"),
                   {"s.toml:12:28: policy.initial: unknown parameter of the policy 'energy_gains'",
                    "'energy_gain'", "known: energy_reference"}));
  EXPECT_TRUE(says(policy_problems("initial = { energy_gain = 0 }"),
                   {"s.toml:12:27: policy.initial.energy_gain = 0", "must be > 0"}));
  EXPECT_EQ(policy_problems("initial = { centring_gain = 0 }"), "");
  EXPECT_TRUE(says(policy_problems("model = { pole_mass = -1 }"),
                   {"s.toml:12:23: policy.model.pole_mass = -1", "must be"}));
  EXPECT_NE(policy_problems("model = { pole_mas = 1 }").find("unknown parameter 'pole_mas'"),
            std::string::npos);
  EXPECT_TRUE(says(policy_problems("elite_fraction = 0.1"),
                   {"s.toml:12:18: policy.elite_fraction", "must be left out", "'power'"}));
  EXPECT_TRUE(
      says(policy_problems("optimizer = 'cross_entropy'\nnum_importance_samples = 3"),
           {"s.toml:13:26: policy.num_importance_samples", "must be left out", "'cross_entropy'"}));
  EXPECT_TRUE(says(policy_problems("min_std = 3"),
                   {"s.toml:12:11: policy.min_std = 3", "must be <= policy.initial_std = 2"}));
  EXPECT_NE(policy_problems("populaton = 3").find("did you mean 'population'?"), std::string::npos);
}

TEST(PolicyProblems, AGridHasTwoAxes) {
  const auto grid = [](const std::string& x, const std::string& y) {
    return policy_problems("grid = { x = {" + x + "}, y = {" + y + "} }");
  };
  const std::string mass = "parameter = 'pole_mass', range = [0.01, 0.03]";
  const std::string length = "parameter = 'pole_length', values = [0.1, 0.12]";
  EXPECT_EQ(grid(mass, length), "");
  EXPECT_NE(grid(mass, mass)
                .find("policy.grid.y.parameter = 'pole_mass', must be another than "
                      "policy.grid.x has"),
            std::string::npos);
  EXPECT_TRUE(says(policy_problems("grid.x = {" + mass + "}"),
                   {"s.toml:12:1: policy.grid has no y", "must have x and y"}));
  EXPECT_NE(grid(mass, "steps = 3")
                .find("policy.grid.y has no parameter = '...', must name a domain parameter"),
            std::string::npos);
  EXPECT_NE(grid(mass, "parameter = 'pole_lenth', values = [1]").find("did you mean 'pole_length'"),
            std::string::npos);
  EXPECT_NE(grid(mass, "parameter = 'pole_length'")
                .find("policy.grid.y has neither range = [low, high] nor values = [...], must have "
                      "one of them"),
            std::string::npos);
  EXPECT_NE(grid(mass, length + ", range = [0.1, 0.2]").find("policy.grid.y has both"),
            std::string::npos);
  EXPECT_NE(grid(mass, "parameter = 'pole_length', range = [0.2, 0.1]")
                .find("must be [low, high] with low < high"),
            std::string::npos);
  EXPECT_NE(grid(mass, "parameter = 'pole_length', values = [0.2, 0.1]").find("must be ascending"),
            std::string::npos);
  EXPECT_NE(grid(mass, "parameter = 'pole_length', values = [-1.0, 0.1]")
                .find("policy.grid.y.values = -1, must be between"),
            std::string::npos);
  EXPECT_NE(grid(mass, "parameter = 'pole_length', values = ['a']")
                .find("must be a list of finite numbers"),
            std::string::npos);
  EXPECT_NE(grid(mass, "parameter = 'pole_length', values = [0.1]")
                .find("policy.grid.y.values = a list of 1, must be a list of 2 or more"),
            std::string::npos);
  EXPECT_NE(grid(mass, length + ", steps = 3")
                .find("policy.grid.y.steps must be left out: it means nothing to values"),
            std::string::npos);
}

// The reader knows before any work what the first search would say.
TEST(PolicyProblems, AModelMustWork) {
  EXPECT_TRUE(says(policy_problems("model = { motor_constant = 0 }"),
                   {"s.toml:12:9: policy.model: the controller's model: motor_constant = 0 V s/rad",
                    "must be > 0"}));
  EXPECT_EQ(policy_problems("model = { motor_constant = 0.04 }"), "");
  const std::string both = policy_problems("model = { pole_mas = 1, pole_length = -1 }");
  EXPECT_NE(both.find("'pole_mas'"), std::string::npos) << both;
  EXPECT_NE(both.find("policy.model.pole_length"), std::string::npos) << both;
}

TEST(PolicyProblems, WhatMeansSomethingToPoliciesAloneNeedsThem) {
  EXPECT_TRUE(
      says(problems_after(kNpe, "num_iterations = 2"),
           {"s.toml:17:18: method.num_iterations", "must be left out without a table [policy]"}));
  EXPECT_TRUE(says(
      problems_after(kNpe, "policy_iterations = 2"),
      {"s.toml:17:21: method.policy_iterations", "must be left out without a table [policy]"}));
  EXPECT_TRUE(says(
      problems_after(kNpe, "algorithm = 'prior'"),
      {"s.toml:17:13: method.algorithm = 'prior'", "must be another without a table [policy]"}));
  const std::string nominal =
      edited(kPolicyText, "name = \"A\"", "name = 'A'\nalgorithm = 'nominal'");
  EXPECT_EQ(problems_of(nominal), "");
  EXPECT_TRUE(says(problems_of(edited(nominal, "'nominal'", "'nominal'\nnum_iterations = 2")),
                   {"s.toml:12:18: method.num_iterations", "must be left out", "'nominal'"}));
}

TEST(PolicyProblems, OnlyASimulatedTargetDomainCanBeAskedForMoreRollouts) {
  const TempFolder folder;
  const std::string recording = folder.file("r.h5", "").string();
  const std::string text = edited(kPolicyText, "name = \"A\"", "name = 'A'\nnum_iterations = 2");
  EXPECT_EQ(problems_of(text), "");
  EXPECT_TRUE(says(problems_of(text, {"target.recording=" + recording}),
                   {"s.toml:11:18: method.num_iterations = 2", "must be 1 without target.truth"}));
}

}  // namespace
}  // namespace npdr::pipeline
