#include "inference/standardiser.h"

#include <gtest/gtest.h>

namespace npdr::inference {
namespace {

TEST(Standardiser, GivesMeanZeroAndDeviationOneWhateverTheBlocks) {
  RowMatrixF x(5, 2);
  x << 1, 10, 2, 30, 3, 20, 4, 50, 5, 40;
  StandardiserFit fit(2);
  fit.add(x.topRows(2));
  fit.add(x.bottomRows(3));
  RowMatrixF z = x;
  fit.result().apply(z);
  EXPECT_TRUE(z.colwise().mean().isZero(1e-6f));
  EXPECT_TRUE((z.colwise().squaredNorm() / 5.0f).isOnes(1e-5f));
}

TEST(Standardiser, LeavesOutAConstantFeature) {
  RowMatrixF x(3, 2);
  x << 0.1f, 1, 0.1f, 2, 0.1f, 3;
  StandardiserFit fit(2);
  fit.add(x);
  fit.result().apply(x);
  EXPECT_TRUE(x.col(0).isZero());
  EXPECT_TRUE(x.allFinite());
}

}  // namespace
}  // namespace npdr::inference
