#include "inference/estimators/dense.h"

#include <gtest/gtest.h>

namespace npdr::inference {
namespace {

const RowMatrix kGroups{{1.0, 2.0}, {3.0, 4.0}, {5.0, 6.0}};

template <typename M>
class Groups : public ::testing::Test {};
using Orders = ::testing::Types<RowMatrix, ColumnMatrixX<double>>;
TYPED_TEST_SUITE(Groups, Orders);

TYPED_TEST(Groups, AreRepeatedAndSummed) {
  for (const Index k : {1, 2, 5}) {
    TypeParam rows;
    repeat_groups(kGroups, 3 * k, rows);
    ASSERT_EQ(rows.rows(), 3 * k);
    for (Index i = 0; i < rows.rows(); ++i) EXPECT_EQ(rows.row(i), kGroups.row(i / k));
    RowMatrix sums(3, 2);
    sum_groups(rows, sums);
    EXPECT_EQ(sums, static_cast<double>(k) * kGroups);
  }
}

TYPED_TEST(Groups, TakeABiasForAllRows) {
  const RowMatrix x{{1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}}, weight{{1.0, 2.0}, {3.0, 4.0}};
  const RowMatrix bias{{10.0, 20.0}};
  TypeParam y;
  dense(x, weight, bias, y);
  EXPECT_EQ(y, (RowMatrix{{11.0, 22.0}, {13.0, 24.0}, {14.0, 26.0}}));
}

}  // namespace
}  // namespace npdr::inference
