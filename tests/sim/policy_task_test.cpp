#include "sim/policy_task.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "core/error.h"
#include "sim/furuta.h"
#include "tests/message_of.h"
#include "tests/sim/angles.h"
#include "tests/sim/hybrid_controller.h"
#include "tests/sim/ode_checks.h"
#include "tests/sim/policy_rows.h"
#include "tests/thread_count.h"

namespace npdr::sim {
namespace {

// Row i of the rows.
PolicyRows only(const PolicyRows& rows, Index i) {
  return {rows.theta.row(i), rows.initial_states.row(i), rows.policies.row(i)};
}

PolicyRows reversed(const PolicyRows& rows) {
  return {rows.theta.colwise().reverse(), rows.initial_states.colwise().reverse(),
          rows.policies.colwise().reverse()};
}

void expect_same_row(const PolicyRollouts& a, Index i, const PolicyRollouts& b, Index j) {
  const auto k = static_cast<std::size_t>(i), l = static_cast<std::size_t>(j);
  EXPECT_TRUE(a.returns(i) == b.returns(j) ||
              (std::isnan(a.returns(i)) && std::isnan(b.returns(j))))
      << "row " << i << ": " << a.returns(i) << ", " << b.returns(j);
  EXPECT_EQ(a.num_steps[k], b.num_steps[l]) << "row " << i;
  EXPECT_EQ(a.success[k], b.success[l]) << "row " << i;
  EXPECT_EQ(a.status[k], b.status[l]) << "row " << i;
}

// Rows that end early, don't work at all or can't be simulated.
void spoil(PolicyRows& rows, Index row, int how) {
  if (how % 4 == 0) rows.policies(row, 2) = -50.0;
  if (how % 4 == 1) rows.policies(row, 4) = kNaN;
  if (how % 4 == 2) rows.theta(row, 5) = -1.0;
  if (how % 4 == 3) rows.initial_states(row, 0) = 3.0;
}

// The closed loop one step at a time: controller and reward by tests/sim/hybrid_controller.h, the
// motion by CVODE with a tolerance of 1e-12, the delay between them by a list of voltages.
struct ReferenceLoop {
  ReferenceLoop(const PolicyRows& row, Index steps) {
    const Furuta model;
    Vector theta = row.theta.row(0).transpose();
    const double delay = theta(parameter_index(model.info(), "action_delay"));
    theta(parameter_index(model.info(), "action_delay")) = 0.0;
    states = RowMatrix(steps + 1, 4);
    states.row(0) = row.initial_states.row(0);
    std::vector<double> voltages;
    for (Index t = 0; t < steps; ++t) {
      const Vector x = states.row(t).transpose();
      const double u = hybrid_controller(row.policies.row(0).transpose(), x);
      total += swing_up_reward(x, u);
      voltages.push_back(std::clamp(u, -4.5, 4.5));
      const double felt = delayed(voltages, delay);
      states.row(t + 1) =
          reference_states(model, theta, {x, RowMatrix::Constant(1, 1, felt)}).row(0);
    }
  }

  static double delayed(const std::vector<double>& voltages, double delay) {
    const double time = std::max(static_cast<double>(voltages.size()) - 1.0 - delay, 0.0);
    const auto before = static_cast<std::size_t>(std::floor(time));
    const auto after = std::min(before + 1, voltages.size() - 1);
    const double share = time - std::floor(time);
    return (1.0 - share) * voltages[before] + share * voltages[after];
  }

  RowMatrix states;
  double total = 0.0;
};

TEST(PolicyTask, AgreesWithAnIndependentClosedLoop) {
  // Accurate steps, and not for long: where the sign of alpha_dot cos(alpha) changes, the voltage
  // jumps, and an error of the state shifts the jump by a whole step or not at all.
  constexpr Index steps = 120;
  const auto task = swing_up(steps, Integrator::erk5, 8);
  const PolicyRows rows = random_rows(8);
  const RecordedPolicyRollouts result = record(*task, rows);
  for (Index i = 0; i < 8; ++i) {
    const ReferenceLoop reference(only(rows, i), steps);
    const Rollout& rollout = result.rollouts[static_cast<std::size_t>(i)];
    ASSERT_EQ(rollout.num_steps(), steps);
    EXPECT_LT((rollout.states - reference.states).cwiseAbs().maxCoeff(), 1e-6) << "row " << i;
    EXPECT_NEAR(result.outcomes.returns(i), reference.total, 1e-6) << "row " << i;
    EXPECT_GT(rollout.actions.cwiseAbs().maxCoeff(), 1.0);
  }
}

TEST(PolicyTask, DefaultStepIsAccurateEnoughForTheWholeTask) {
  const PolicyRows rows = random_rows(8);
  const PolicyRollouts coarse = run(*swing_up(200), rows);
  const PolicyRollouts exact = run(*swing_up(200, Integrator::cvode), rows);
  for (Index i = 0; i < 8; ++i) EXPECT_NEAR(coarse.returns(i), exact.returns(i), 1e-3);
}

TEST(PolicyTask, ReplayOfARolloutsActionsIsThatRollout) {
  const auto simulator = make_simulator({.name = "furuta"});
  const PolicyRows rows = random_rows(3);
  const RecordedPolicyRollouts result = record(*swing_up(), rows);
  for (Index i = 0; i < 3; ++i) {
    const Rollout& rollout = result.rollouts[static_cast<std::size_t>(i)];
    ASSERT_EQ(rollout.num_steps(), 1250);
    Target target = simulator->behave(complete_theta(*simulator, {}), 1, 1);
    target.rollouts = {rollout};
    const Trajectories replayed = simulator->replay(target, rows.theta.row(i));
    EXPECT_EQ(replayed.rollout(0, 0), rollout.states.bottomRows(1250).cast<float>());
  }
}

TEST(PolicyTask, InitialPolicySwingsTheNominalPendulumUp) {
  const auto task = swing_up();
  const auto simulator = make_simulator({.name = "furuta"});
  const RowMatrix theta = complete_theta(*simulator, {}).transpose().replicate(20, 1);
  const RowMatrix policies = initial_policy(task->info()).transpose().replicate(20, 1);
  const PolicyRollouts result =
      task->run(theta, task->initial_states(20, {1, "initial"}), policies);
  for (Index i = 0; i < 20; ++i) {
    EXPECT_EQ(result.success[static_cast<std::size_t>(i)], 1);
    EXPECT_EQ(result.num_steps[static_cast<std::size_t>(i)], 1250);
    EXPECT_GT(result.returns(i), 500.0);
    EXPECT_LT(result.returns(i), 1250.0);
  }
}

TEST(PolicyTask, RolloutEndsWhereItLeavesTheLimits) {
  const auto task = swing_up();
  PolicyRows rows = random_rows(2);
  rows.policies(0, 2) = -50.0;  // pushes the arm away from its center
  const RecordedPolicyRollouts result = record(*task, rows);
  const Rollout& rollout = result.rollouts[0];
  const Index steps = result.outcomes.num_steps[0];
  ASSERT_GT(steps, 10);
  ASSERT_LT(steps, 1250);
  EXPECT_EQ(rollout.num_steps(), steps);
  EXPECT_EQ(rollout.states.rows(), steps + 1);
  EXPECT_GT(std::abs(rollout.states(steps, 0)), 115.0 * kDegree);
  EXPECT_LT(rollout.states.topRows(steps).col(0).cwiseAbs().maxCoeff(), 115.0 * kDegree);
  double sum = 0.0;
  for (Index t = 0; t < steps; ++t) {
    const Vector x = rollout.states.row(t).transpose();
    sum += swing_up_reward(x, hybrid_controller(rows.policies.row(0).transpose(), x));
  }
  EXPECT_NEAR(result.outcomes.returns(0), sum, 1e-10);
  EXPECT_EQ(result.outcomes.success[0], 0);
  EXPECT_EQ(result.outcomes.status[0], RolloutStatus::ok);
  EXPECT_EQ(result.outcomes.num_steps[1], 1250);
}

TEST(PolicyTask, WhatCantBeRunEarnsNothing) {
  const auto task = swing_up(100);
  PolicyRows rows = random_rows(4);
  rows.initial_states(1, 0) = 2.5;       // beyond the limits
  rows.policies(2, 1) = kNaN;            // no action
  rows.initial_states.row(3).setZero();  // infinity times sign(0)
  rows.policies(3, 1) = kInfinity;
  const PolicyRollouts result = run(*task, rows);
  EXPECT_EQ(result.num_steps, (std::vector<Index>{100, 0, 0, 0}));
  EXPECT_GT(result.returns(0), 0.0);
  EXPECT_EQ(result.returns.tail(3), Vector::Zero(3));
  EXPECT_EQ(result.status, std::vector<RolloutStatus>(4, RolloutStatus::ok));
}

TEST(PolicyTask, ImpossibleDomainParametersAreAFailedRow) {
  const auto task = swing_up(50);
  PolicyRows rows = random_rows(3);
  rows.theta(1, parameter_index(make_simulator({.name = "furuta"})->info(), "pole_mass")) = -0.01;
  const PolicyRollouts result = run(*task, rows);
  EXPECT_EQ(result.status[1], RolloutStatus::out_of_limits);
  EXPECT_TRUE(std::isnan(result.returns(1)));
  EXPECT_EQ(result.num_steps[1], 0);
  EXPECT_EQ(result.status[2], RolloutStatus::ok);
  EXPECT_EQ(task->possible_rows(rows.theta), (std::vector<Index>{0, 2}));
}

TEST(PolicyTask, EveryDomainParameterActsOnTheReturn) {
  const auto task = swing_up();
  const auto simulator = make_simulator({.name = "furuta"});
  const Index count = static_cast<Index>(simulator->info().parameters.size());
  RowMatrix theta =
      complete_theta(*simulator, {{"cable_stiffness", 1e-3}}).transpose().replicate(count + 1, 1);
  for (Index p = 0; p < 9; ++p) theta(p + 1, p) *= 1.05;
  const Vector extension{{-0.2, 0.2, 1.5, 1e-3, 2e-3, 0.2}};
  for (Index p = 9; p < count; ++p) theta(p + 1, p) = extension(p - 9);
  const RowMatrix start = Vector{{0.01, 0.01, 0.0, 0.0}}.transpose().replicate(count + 1, 1);
  const RowMatrix policies = initial_policy(task->info()).transpose().replicate(count + 1, 1);
  const PolicyRollouts result = task->run(theta, start, policies);
  for (Index p = 0; p < count; ++p) {
    EXPECT_NE(result.returns(p + 1), result.returns(0))
        << simulator->info().parameters[static_cast<std::size_t>(p)].name;
  }
}

TEST(PolicyTask, SameBitsForAnyThreadCount) {
  const auto task = swing_up(150);
  PolicyRows rows = random_rows(300);
  for (Index row = 0; row < 300; row += 30) spoil(rows, row, static_cast<int>(row / 30));
  const PolicyRollouts serial = [&] {
    const ThreadCount one(1);
    return run(*task, rows);
  }();
  for (const int count : {2, 3, 16}) {
    const ThreadCount threads(count);
    const PolicyRollouts parallel = run(*task, rows);
    for (Index i = 0; i < 300; ++i) expect_same_row(serial, i, parallel, i);
  }
}

TEST(PolicyTask, SameBitsAloneInABatchAndAtAnyPosition) {
  PolicyRows rows = random_rows(70);
  for (Index row = 3; row < 70; row += 9) spoil(rows, row, static_cast<int>(row));
  for (const Integrator integrator : {Integrator::erk4, Integrator::erk2, Integrator::cvode}) {
    const auto task = swing_up(150, integrator);
    const PolicyRollouts all = run(*task, rows);
    const PolicyRollouts backwards = run(*task, reversed(rows));
    for (Index i = 0; i < 70; ++i) {
      expect_same_row(all, i, run(*task, only(rows, i)), 0);
      expect_same_row(all, i, backwards, 69 - i);
    }
  }
}

TEST(PolicyTask, RecordingChangesNoOutcome) {
  const auto task = swing_up(300);
  PolicyRows rows = random_rows(20);
  spoil(rows, 4, 0);
  const PolicyRollouts plain = run(*task, rows);
  const RecordedPolicyRollouts recorded = record(*task, rows);
  for (Index i = 0; i < 20; ++i) expect_same_row(plain, i, recorded.outcomes, i);
}

TEST(PolicyTask, NoRowsAreNoRollouts) {
  const auto task = swing_up();
  EXPECT_EQ(task->run(RowMatrix(0, 15), RowMatrix(0, 4), RowMatrix(0, 7)).num_rows(), 0);
}

TEST(PolicyTask, RowsOfOtherShapesAreAnError) {
  const auto task = swing_up();
  const PolicyRows rows = random_rows(2);
  EXPECT_THROW(task->run(rows.theta.leftCols(9), rows.initial_states, rows.policies), ShapeError);
  EXPECT_THROW(task->run(rows.theta, rows.initial_states.leftCols(3), rows.policies), ShapeError);
  EXPECT_THROW(task->run(rows.theta, rows.initial_states, rows.policies.leftCols(6)), ShapeError);
  EXPECT_THROW(task->run(rows.theta, rows.initial_states.topRows(1), rows.policies), ShapeError);
  EXPECT_THROW(task->run(rows.theta, rows.initial_states, rows.policies.topRows(1)), ShapeError);
}

TEST(PolicyTask, InitialStatesAreUniformAndDependOnTheirRowAlone) {
  const auto task = swing_up();
  const RowMatrix states = task->initial_states(2000, {3, "initial"});
  EXPECT_EQ(task->initial_states(5, {3, "initial"}), states.topRows(5));
  EXPECT_NE(task->initial_states(5, {4, "initial"}), states.topRows(5));
  const Vector half_width = Vector{{2.0, 1.0, 0.5, 0.5}} * kDegree;
  for (Index s = 0; s < 4; ++s) {
    EXPECT_LE(states.col(s).cwiseAbs().maxCoeff(), half_width(s));
    // Standard error of the mean is 1 / sqrt(3 * 2000) half widths; five of them, for four columns:
    // false alarm 2e-6.
    EXPECT_LT(std::abs(states.col(s).mean()), 5.0 * half_width(s) / std::sqrt(6000.0));
    EXPECT_GT(states.col(s).maxCoeff(), 0.98 * half_width(s));  // false alarm 2e-9
  }
}

TEST(PolicyTask, SearchSpaceHasLogarithmsOfPositiveParameters) {
  const PolicyTaskInfo info = swing_up()->info();
  const RowMatrix policies = random_rows(4).policies;
  const RowMatrix points = to_search_space(info, policies);
  EXPECT_DOUBLE_EQ(points(1, 0), std::log(policies(1, 0)));
  EXPECT_DOUBLE_EQ(points(1, 1), std::log(policies(1, 1)));
  EXPECT_EQ(points.rightCols(5), policies.rightCols(5));
  EXPECT_LT((from_search_space(info, points) - policies).cwiseAbs().maxCoeff(), 1e-13);
  RowMatrix negative = policies;
  negative(2, 1) = -1.0;
  const std::string message = message_of<InputError>([&] { to_search_space(info, negative); });
  EXPECT_TRUE(has(message, "energy_gain = -1, must be > 0"));
  EXPECT_THROW(from_search_space(info, points.leftCols(6)), ShapeError);
}

TEST(PolicyTask, SimulatorsWithoutOneSaySo) {
  EXPECT_EQ(simulators_with_policy_task(), (std::vector<std::string>{"furuta"}));
  EXPECT_EQ(make_simulator({.name = "pendulum"})->policy_task({}), nullptr);
  EXPECT_TRUE(says(message_of<InputError>([] { make_policy_task({.name = "pendulum"}); }),
                   {"simulator 'pendulum' has no policy task", "those with one"}));
}

TEST(PolicyTask, ControllersModelIsNominalUnlessTheConfigSaysOtherwise) {
  const PolicyRows rows = random_rows(1);
  const auto total = [&](const SimulatorConfig& simulator, const PolicyTaskConfig& config) {
    return run(*make_policy_task(simulator, config), rows).returns(0);
  };
  const double nominal = total({.name = "furuta"}, {});
  const double believed = total({.name = "furuta"}, {.model = {{"pole_mass", 0.03}}});
  EXPECT_NE(believed, nominal);
  EXPECT_EQ(total({.name = "furuta", .parameters = {{"pole_mass", 0.03}}}, {}), believed);
}

TEST(PolicyTask, ConfigOutOfRangeIsAnError) {
  const auto problem = [](const PolicyTaskConfig& config) {
    return message_of<InputError>([&] { make_policy_task({.name = "furuta"}, config); });
  };
  EXPECT_EQ(problem({.num_steps = -1}), "policy.num_steps = -1, must be >= 0");
  EXPECT_TRUE(says(problem({.model = {{"pole_mass", -1.0}}}),
                   {"policy.model.pole_mass = -1", "must be in [0.0001, 10] kg"}));
  EXPECT_TRUE(has(problem({.model = {{"pole_mas", 1.0}}}), "did you mean 'pole_mass'"));
}

}  // namespace
}  // namespace npdr::sim
