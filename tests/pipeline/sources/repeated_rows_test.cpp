#include "pipeline/sources/repeated_rows.h"

#include <gtest/gtest.h>

#include "core/constants.h"

namespace npdr::pipeline {
namespace {

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
  EXPECT_EQ(repeated_rows(theta(64), with_zeros(3)).substr(0, 41),
            "3 of the first 64 rows are the same to th");
  EXPECT_EQ(repeated_rows(theta(64), with_zeros(2)), "") << "by chance";
  EXPECT_EQ(repeated_rows(theta(64), rows(64)), "");
}

TEST(RepeatedRows, AreNoneOfTheSameParameters) {
  RowMatrix same = theta(64);
  for (Index i = 0; i < 3; ++i) same(5 + 7 * i, 0) = 0.0;
  EXPECT_EQ(repeated_rows(same, with_zeros(3)), "");
}

TEST(RepeatedRows, AreUsualAmongCounts) {
  RowMatrixF x(64, 1);
  for (Index i = 0; i < 64; ++i) x(i, 0) = static_cast<float>(i % 9);
  EXPECT_EQ(repeated_rows(theta(64), x), "");
}

TEST(RepeatedRows, DontCountFailures) {
  RowMatrixF x = with_zeros(3);
  for (float& value : x.col(0)) value = value == 0.0f ? kFloatNaN : value;
  EXPECT_EQ(repeated_rows(theta(64), x), "");
}

}  // namespace
}  // namespace npdr::pipeline
