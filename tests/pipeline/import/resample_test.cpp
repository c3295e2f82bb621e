#include "pipeline/import/csv_times.h"

#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "tests/message_of.h"

namespace npdr::pipeline {
namespace {

CsvRows rows_at(const std::vector<double>& times) {
  CsvRows rows;
  rows.name = "a.csv";
  rows.times = times;
  const auto n = static_cast<Index>(times.size());
  rows.rollout = {"a", RowMatrix(n, 2), RowMatrix(n - 1, 1)};
  return rows;
}

// States that are linear in time, actions that count rows.
CsvRows ramp(const std::vector<double>& times) {
  CsvRows rows = rows_at(times);
  for (Index t = 0; t < std::ssize(times); ++t) {
    const double time = times[static_cast<std::size_t>(t)];
    rows.rollout.states.row(t) << 3.0 * time, 1.0 - time;
    if (t + 1 < std::ssize(times)) rows.rollout.actions(t, 0) = static_cast<double>(t);
  }
  return rows;
}

Rollout even(const std::vector<double>& times, double dt) {
  const CsvRows rows = ramp(times);
  return resampled(rows, rows.rollout, dt);
}

TEST(Resample, InterpolatesStatesLinearly) {
  const Rollout found = even({5.0, 5.13, 5.19, 5.32, 5.4}, 0.1);
  ASSERT_EQ(found.states.rows(), 5);
  for (Index t = 0; t < 5; ++t) {
    const double time = 5.0 + 0.1 * static_cast<double>(t);
    EXPECT_NEAR(found.states(t, 0), 3.0 * time, 1e-12);
    EXPECT_NEAR(found.states(t, 1), 1.0 - time, 1e-12);
  }
}

TEST(Resample, ActionsAreThoseHeldForMostOfAStep) {
  EXPECT_EQ(even({0.0, 0.13, 0.19, 0.32, 0.4}, 0.1).actions, (RowMatrix{{0}, {1}, {2}, {3}}));
  EXPECT_EQ(even({0.0, 0.1, 0.2, 0.3, 0.4}, 0.2).actions.rows(), 2);
  EXPECT_EQ(even({0.0, 0.4, 0.8}, 0.2).actions, (RowMatrix{{0}, {0}, {1}, {1}}));
}

TEST(Resample, RoundedTimesOfAnEvenClockKeepEveryRow) {
  std::vector<double> times;
  for (int t = 0; t <= 90; ++t) times.push_back(std::round(1000.0 * t / 30.0) / 1000.0);
  const CsvRows rows = ramp(times);
  const Rollout found = even(times, 1.0 / 30.0);
  ASSERT_EQ(found.actions.rows(), 90);
  EXPECT_EQ(found.actions, rows.rollout.actions);
  EXPECT_LT((found.states - rows.rollout.states).cwiseAbs().maxCoeff(), 3.0 * 0.0006);
}

// A line between samples h apart is at most h^2 / 8 times the second derivative off.
TEST(Resample, TheErrorOfALineIsItsCurvature) {
  std::vector<double> times = {0.0};
  Stream stream({1, "clock", 0, 0, 0});
  while (times.back() < 4.0) times.push_back(times.back() + 0.01 * (0.5 + stream.uniform()));
  CsvRows rows = rows_at(times);
  for (Index t = 0; t < rows.rollout.states.rows(); ++t) {
    rows.rollout.states.row(t).setConstant(std::sin(5.0 * times[static_cast<std::size_t>(t)]));
  }
  rows.rollout.actions.setZero();
  const Rollout found = resampled(rows, rows.rollout, 0.01);
  for (Index t = 0; t < found.states.rows(); ++t) {
    EXPECT_NEAR(found.states(t, 0), std::sin(0.05 * static_cast<double>(t)),
                25.0 * 0.015 * 0.015 / 8.0);
  }
}

TEST(Resample, AStepThatFillsTheMemoryIsRefused) {
  EXPECT_TRUE(says(message_of<InputError>([] {
                     even({0.0, 0.1}, 1e-9);
                   }),
                   {"--resample 1e-09 makes 1e+08 steps of 2 rows", "must make 1 to 2000"}));
  EXPECT_TRUE(says(message_of<InputError>([] {
                     even({0.0, 0.1}, 1e-300);
                   }),
                   {"--resample 1e-300 makes 1e+299 steps of 2 rows", "must make 1 to 2000"}));
  EXPECT_EQ(even({0.0, 0.1}, 0.1 / 2000.0).actions.rows(), 2000);
}

}  // namespace
}  // namespace npdr::pipeline
