#include "pipeline/sources/first_rows.h"

#include <gtest/gtest.h>

#include "core/constants.h"
#include "core/random.h"
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
  RowMatrixF x = RowMatrixF::Constant(64, 1, 7.0f);
  EXPECT_TRUE(has(words_of(find_same_rows(theta(64), x)), "all 64 finite rows of the first 64"));
  x(9, 0) = kFloatNaN;
  EXPECT_TRUE(has(words_of(find_same_rows(theta(64), x)), "all 63 finite rows of the first 64"));
  EXPECT_EQ(words_of(find_same_rows(theta(7), x.topRows(7))), "") << "too few to tell";
}

TEST(RepeatedRows, AreNoneOfTheSameParameters) {
  RowMatrix same = theta(64);
  for (Index i = 0; i < 3; ++i) same(5 + 7 * i, 0) = 0.0;
  EXPECT_EQ(words_of(find_same_rows(same, with_zeros(3))), "");
  same(5, 0) = 1.0;
  EXPECT_EQ(words_of(find_same_rows(same, with_zeros(3))), "") << "two designs, one of them twice";
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

const std::vector<Channel> kColumns = {{"far", "m"}, {"near", "m"}};

RowMatrix varying(double mean, double deviation) {
  RowMatrix x(20, 2);
  for (Index i = 0; i < x.rows(); ++i) {
    x.row(i) << mean + (i % 2 == 0 ? deviation : -deviation), static_cast<double>(i);
  }
  return x;
}

TEST(Precision, SaysWhichColumnsFloatsCantTellApart) {
  EXPECT_TRUE(says(words_of(find_lost_precision(varying(1e8, 1.5), kColumns)),
                   {"single precision", "'far' by 1.5 about 1e+08", "subtract an offset"}));
  EXPECT_FALSE(has(words_of(find_lost_precision(varying(1e8, 1.5), kColumns)), "'near'"));
  EXPECT_NE(words_of(find_lost_precision(varying(0.0, 1e-37), kColumns)), "");
  EXPECT_NE(words_of(find_lost_precision(varying(0.0, 1e-300), kColumns)), "")
      << "whose square is 0";
  RowMatrix partly_lost = varying(1e8, 1.5);
  partly_lost(3, 1) = kNaN;
  EXPECT_NE(words_of(find_lost_precision(partly_lost, kColumns)), "");
}

TEST(Precision, SaysNothingOfConstantsAndOfWhatFloatsHold) {
  EXPECT_EQ(words_of(find_lost_precision(varying(1e8, 1000.0), kColumns)), "");
  EXPECT_EQ(words_of(find_lost_precision(varying(0.0, 1e-30), kColumns)), "");
  EXPECT_EQ(words_of(find_lost_precision(varying(0.1, 0.0), kColumns)), "");
  EXPECT_EQ(words_of(find_lost_precision(varying(0.1, 1e-16), kColumns)), "");
  EXPECT_EQ(words_of(find_lost_precision(varying(1e8, 1.5).topRows(7), kColumns)), "");
}

class RepeatedOutlier : public testing::Test {
 protected:
  // 64 rows of two standard normal columns.
  RepeatedOutlier() : x_(64, 2) {
    Stream stream({1, "test", 0, 0, 0});
    for (float& value : x_.reshaped()) value = static_cast<float>(stream.normal());
  }

  // Of two blocks.
  std::string found() const {
    RepeatedOutliers outliers(2);
    outliers.observe(x_.topRows(40));
    outliers.observe(x_.bottomRows(24));
    return words_of(outliers.find({{"total", "1"}, {"peak", "m"}}));
  }

  RowMatrixF x_;
};

TEST_F(RepeatedOutlier, AreNamedWithTheirNumber) {
  x_(3, 1) = x_(40, 1) = x_(41, 1) = -999.0f;
  EXPECT_TRUE(says(found(), {"'peak' is -999 in 3 of 64 rows", "write NaN"}));
  x_(3, 1) = x_(40, 1) = x_(41, 1) = 1e30f;
  EXPECT_TRUE(says(found(), {"'peak' is 1e+30 in 3 of 64 rows"}));
}

TEST_F(RepeatedOutlier, AreNoneOfWhatMeasurementsDo) {
  EXPECT_EQ(found(), "");
  x_(3, 1) = 50.0f;
  EXPECT_EQ(found(), "") << "a heavy tail doesn't repeat itself";
  x_.col(0) = x_.col(0).cwiseMax(-0.5f);
  EXPECT_EQ(found(), "") << "a sensor that is clipped";
  for (Index i = 0; i < 64; ++i) x_(i, 0) = i % 2 == 0 ? 0.0f : 1.0f;
  EXPECT_EQ(found(), "") << "a bit";
  x_.col(0).setConstant(kFloatNaN);
  EXPECT_EQ(found(), "") << "nothing there";
}

}  // namespace
}  // namespace npdr::pipeline
