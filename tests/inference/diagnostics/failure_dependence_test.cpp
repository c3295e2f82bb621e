#include "inference/diagnostics/failure_dependence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/error.h"
#include "tests/inference/diagnostics/samples.h"
#include "tests/thread_count.h"

namespace npdr::inference {
namespace {

const StreamId kFailuresId{1, "failures", 0, 0, 0};

std::vector<bool> rows_where(const RowMatrix& u,
                             const std::function<bool(const Eigen::RowVectorXd&)>& fails) {
  std::vector<bool> failed;
  for (Index i = 0; i < u.rows(); ++i) failed.push_back(fails(u.row(i)));
  return failed;
}

// Every 20th row, of which nothing is special.
std::vector<bool> any_rows(Index n) {
  std::vector<bool> failed(static_cast<std::size_t>(n));
  for (std::size_t i = 0; i < failed.size(); i += 20) failed[i] = true;
  return failed;
}

// p < 0.05 in 10 of 200 trials, with a standard error of 3.1: at most 20, whatever the number of
// parameters. False-alarm rate 2e-3.
TEST(FailureDependence, FalseAlarmsAreAsRareAsTheySay) {
  for (const Index dimension : {1, 12}) {
    int alarms = 0;
    for (std::uint64_t trial = 1; trial <= 200; ++trial) {
      const RowMatrix u = gaussian(100, dimension, trial);
      const FailureDependence found =
          test_failures(u, any_rows(100), {trial, "failures", 0, 0, 0}, {.num_permutations = 200});
      alarms += found.p_value < 0.05 ? 1 : 0;
    }
    EXPECT_LE(alarms, 20) << dimension;
    EXPECT_GE(alarms, 2) << dimension;
  }
}

TEST(FailureDependence, FindsABorderAmongManyParameters) {
  const RowMatrix u = gaussian(500, 20, 1);
  const FailureDependence found =
      test_failures(u, rows_where(u, [](const auto& row) { return row(7) > 1.7; }), kFailuresId);
  EXPECT_LT(found.p_value, 1e-4);
  EXPECT_EQ(found.term, (std::pair<Index, Index>{7, -1}));
  EXPECT_GT(found.shift, 1.5);
  EXPECT_EQ(found.num_failed + found.num_good, 500);
}

// Neither is to be seen in any mean.
TEST(FailureDependence, FindsBothEndsAndPairs) {
  const RowMatrix u = gaussian(500, 5, 2);
  const FailureDependence ends = test_failures(
      u, rows_where(u, [](const auto& row) { return std::abs(row(2)) > 1.9; }), kFailuresId);
  EXPECT_LT(ends.p_value, 1e-3);
  EXPECT_EQ(ends.term, (std::pair<Index, Index>{2, 2}));
  const FailureDependence pair = test_failures(
      u, rows_where(u, [](const auto& row) { return row(1) * row(3) > 1.3; }), kFailuresId);
  EXPECT_LT(pair.p_value, 1e-3);
  EXPECT_EQ(pair.term, (std::pair<Index, Index>{1, 3}));
}

TEST(FailureDependence, FindsTheSameWhereMostRowsFail) {
  const RowMatrix u = gaussian(300, 3, 3);
  const FailureDependence found =
      test_failures(u, rows_where(u, [](const auto& row) { return row(0) > -1.0; }), kFailuresId);
  EXPECT_LT(found.p_value, 1e-4);
  EXPECT_EQ(found.term, (std::pair<Index, Index>{0, -1}));
  EXPECT_GT(found.shift, 1.0);
}

TEST(FailureDependence, NothingIsSaidOfNothing) {
  const RowMatrix u = gaussian(50, 2, 1);
  EXPECT_EQ(test_failures(u, std::vector<bool>(50, false), kFailuresId).p_value, 1.0);
  EXPECT_EQ(test_failures(u, std::vector<bool>(50, true), kFailuresId).p_value, 1.0);
  EXPECT_GT(test_failures(RowMatrix::Zero(50, 2), any_rows(50), kFailuresId).p_value, 0.5);
  EXPECT_THROW(test_failures(u, std::vector<bool>(49), kFailuresId), ShapeError);
}

TEST(FailureDependence, SameBitsForAnyThreadCount) {
  const RowMatrix u = gaussian(200, 3, 1);
  expect_same_for_any_thread_count(
      [&] { return test_failures(u, any_rows(200), kFailuresId).p_value; });
}

}  // namespace
}  // namespace npdr::inference
