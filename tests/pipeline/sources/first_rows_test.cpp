#include "pipeline/sources/first_rows.h"

#include <gtest/gtest.h>

#include "core/constants.h"
#include "tests/message_of.h"
#include "tests/words_of.h"

namespace npdr::pipeline {
namespace {

// Two rollouts of three steps.
Target recorded() {
  Target target{0.1, {{"q", "m"}}, {}, {}, "test"};
  for (const double first : {0.25, 1.5}) {
    RowMatrix states(4, 1);
    states << first, first + 1.0, first + 2.0, first + 3.0;
    target.rollouts.push_back({"r", states, RowMatrix(3, 0)});
  }
  return target;
}

// Two rows of them, `steps` later than right.
sim::Trajectories simulated(Index late) {
  sim::Trajectories x;
  x.resize(2, 2, 3, 1);
  for (Index i = 0; i < 2; ++i) {
    for (Index k = 0; k < 6; ++k) {
      const double first = k < 3 ? 0.25 : 1.5;
      const double value = first + static_cast<double>(k % 3 + 1 - late) * (1.0 + 0.1 * double(i));
      x.row(i)[static_cast<std::size_t>(k)] = static_cast<float>(value);
    }
  }
  return x;
}

TEST(LateStates, AreFoundInAllRows) {
  EXPECT_EQ(words_of(find_late_states(simulated(0), recorded())), "");
  EXPECT_TRUE(has(words_of(find_late_states(simulated(1), recorded())), "all come a step late"));
  sim::Trajectories mixed = simulated(1);
  mixed.row(1)[3] = 7.0f;
  EXPECT_EQ(words_of(find_late_states(mixed, recorded())), "");
}

TEST(LateStates, AreNoneOfWhatRestsAtFirst) {
  Target target = recorded();
  target.rollouts[1].states(1, 0) = target.rollouts[1].states(0, 0);
  EXPECT_EQ(words_of(find_late_states(simulated(1), target)), "");
}

TEST(LateStates, DontCountFailures) {
  sim::Trajectories x = simulated(1);
  x.status[1] = sim::RolloutStatus::diverged;
  x.row(1)[0] = 9.0f;
  EXPECT_NE(words_of(find_late_states(x, recorded())), "");
  x.status[0] = sim::RolloutStatus::diverged;
  EXPECT_EQ(words_of(find_late_states(x, recorded())), "");
}

// Rows that all differ.
RowMatrixF rows(Index n) {
  RowMatrixF x(n, 2);
  for (Index i = 0; i < n; ++i) x.row(i) << static_cast<float>(i), 1.0f / static_cast<float>(i + 1);
  return x;
}

RowMatrix theta(Index n) {
  return RowMatrix::NullaryExpr(n, 1, [](Index i) { return 0.1 * double(i); });
}

RowMatrixF with_zeros(Index count, Index n = 64) {
  RowMatrixF x = rows(n);
  for (Index i = 0; i < count; ++i) x.row(5 + 7 * i).setZero();
  return x;
}

TEST(RepeatedRows, AreCounted) {
  EXPECT_EQ(words_of(find_same_rows(theta(64), with_zeros(3))).substr(0, 41),
            "3 of the first 64 rows are the same to th");
  EXPECT_EQ(words_of(find_same_rows(theta(64), with_zeros(2))), "") << "by chance";
  EXPECT_EQ(words_of(find_same_rows(theta(64), rows(64))), "");
}

TEST(RepeatedRows, AreToldWhereAllAre) {
  const RowMatrixF x = RowMatrixF::Constant(64, 1, 7.0f);
  EXPECT_NE(words_of(find_same_rows(theta(64), x)).find("all of the first 64 rows"),
            std::string::npos);
  EXPECT_EQ(words_of(find_same_rows(theta(7), x.topRows(7))), "") << "too few to tell";
}

TEST(RepeatedRows, AreNoneOfTheSameParameters) {
  RowMatrix same = theta(64);
  for (Index i = 0; i < 3; ++i) same(5 + 7 * i, 0) = 0.0;
  EXPECT_EQ(words_of(find_same_rows(same, with_zeros(3))), "");
}

TEST(RepeatedRows, AreUsualAmongCounts) {
  RowMatrixF x(64, 1);
  for (Index i = 0; i < 64; ++i) x(i, 0) = static_cast<float>(i % 9);
  EXPECT_EQ(words_of(find_same_rows(theta(64), x)), "");
}

TEST(RepeatedRows, DontCountFailures) {
  RowMatrixF x = with_zeros(3);
  for (float& value : x.col(0)) value = value == 0.0f ? kFloatNaN : value;
  EXPECT_EQ(words_of(find_same_rows(theta(64), x)), "");
}

}  // namespace
}  // namespace npdr::pipeline
