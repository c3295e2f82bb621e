#include "pipeline/sources/first_rows.h"

#include <gtest/gtest.h>

#include "core/constants.h"
#include "core/random.h"
#include "tests/message_of.h"
#include "tests/words_of.h"

namespace npdr::pipeline {
namespace {

TEST(ConstantRows, AreToldOfEightOrMoreFiniteOnes) {
  RowMatrixF x = RowMatrixF::Constant(64, 1, 7.0f);
  EXPECT_TRUE(has(words_of(find_constant_rows(x)), "all 64 finite rows of the first 64"));
  x(9, 0) = kFloatNaN;
  EXPECT_TRUE(has(words_of(find_constant_rows(x)), "all 63 finite rows of the first 64"));
  EXPECT_EQ(words_of(find_constant_rows(x.topRows(7))), "") << "too few to tell";
  x(3, 0) = 8.0f;
  EXPECT_EQ(words_of(find_constant_rows(x)), "");
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
  EXPECT_NE(words_of(find_lost_precision(varying(0.0, 1e-39), kColumns)), "");
  EXPECT_NE(words_of(find_lost_precision(varying(0.0, 1e-300), kColumns)), "")
      << "whose square is 0";
  RowMatrix partly_lost = varying(1e8, 1.5);
  partly_lost(3, 1) = kNaN;
  EXPECT_NE(words_of(find_lost_precision(partly_lost, kColumns)), "");
}

TEST(Precision, SaysNothingOfConstantsAndOfWhatFloatsHold) {
  EXPECT_EQ(words_of(find_lost_precision(varying(1e8, 1000.0), kColumns)), "");
  EXPECT_EQ(words_of(find_lost_precision(varying(0.0, 1e-36), kColumns)), "");
  EXPECT_EQ(words_of(find_lost_precision(varying(0.1, 0.0), kColumns)), "");
  EXPECT_EQ(words_of(find_lost_precision(varying(0.1, 1e-16), kColumns)), "");
  EXPECT_EQ(words_of(find_lost_precision(varying(1e8, 1.5).topRows(7), kColumns)), "");
}

class RowsApart : public testing::Test {
 protected:
  // 200 rows that are numbered from 1.
  RowsApart() : rows_{RowMatrix(200, 1), RowMatrixF(200, 2), {{"total", "1"}, {"peak", "m"}}} {
    Stream stream({1, "test", 0, 0, 0});
    for (Index i = 0; i < 200; ++i) {
      rows_.theta(i, 0) = stream.normal();
      for (float& value : rows_.x.row(i)) {
        value = static_cast<float>(rows_.theta(i, 0) + 0.1 * stream.normal());
      }
      rows_.numbers.push_back(i + 1);
    }
  }

  RowsTogether rows_;
};

TEST_F(RowsApart, AreNamedWithTheirNumbers) {
  EXPECT_EQ(words_of(find_apart(rows_)), "");
  rows_.x(3, 1) = rows_.x(40, 1) = rows_.x(41, 1) = -999.0f;
  EXPECT_TRUE(says(words_of(find_apart(rows_)), {"'peak' is -999 in 3 of 200 rows", "Write NaN"}));
  rows_.features.clear();
  EXPECT_EQ(words_of(find_apart(rows_)), "") << "motion may gather somewhere";
}

TEST_F(RowsApart, AreAStretchThatIsWrong) {
  rows_.x.bottomRows(40).colwise().reverseInPlace();
  const Findings found = find_apart(rows_);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].severity, Severity::wrong);
  EXPECT_TRUE(has(found[0].what, {"rows 160 to 200 don't go with their parameters"}));
}

TEST_F(RowsApart, AreTheSameOfOtherParameters) {
  for (Index i = 0; i < 5; ++i) rows_.x.row(7 * i) = rows_.x.row(7 * i + 60);
  EXPECT_TRUE(has(words_of(find_apart(rows_)), {"the very x of others", "10 of 200 rows"}));
}

}  // namespace
}  // namespace npdr::pipeline
