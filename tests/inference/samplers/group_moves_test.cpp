#include "inference/samplers/group_moves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/inference/gradient_check.h"

namespace npdr::inference {
namespace {

const LogDensity kStandardNormal = [](const RowMatrix& u) -> Vector {
  return -0.5 * u.rowwise().squaredNorm();
};

// 1000 draws of N(0, I), each there four times, are 4000 nearly independent ones after 200 sweeps:
// means are N(0, 1/4000) and variances N(1, 2/4000); 4 deviations, 4 numbers: 3e-4 false alarms.
TEST(GroupMoves, LeaveTheDensityAsItIsAndTellRepeatsApart) {
  RowMatrix u = random_matrix(1000, 2, 1).replicate(4, 1);
  Stream stream({1, "moves", 0, 0, 0});
  move_group(u, kStandardNormal, 200, stream);
  std::set<double> different(u.col(0).begin(), u.col(0).end());
  EXPECT_GT(different.size(), 3990u);
  for (Index d = 0; d < 2; ++d) {
    EXPECT_NEAR(u.col(d).mean(), 0.0, 4.0 / std::sqrt(4000.0));
    EXPECT_NEAR(u.col(d).squaredNorm() / 4000.0, 1.0, 4.0 * std::sqrt(2.0 / 4000.0));
  }
}

// False alarms: 6e-5.
TEST(GroupMoves, MendDrawsThatAreTooNarrow) {
  RowMatrix u = 0.3 * random_matrix(500, 3, 1);
  Stream stream({1, "moves", 0, 0, 0});
  move_group(u, kStandardNormal, 100, stream);
  EXPECT_NEAR(u.squaredNorm() / 1500.0, 1.0, 4.0 * std::sqrt(2.0 / 1500.0));
}

TEST(GroupMoves, NobodyGoesWhereTheDensityIsNan) {
  RowMatrix u = random_matrix(100, 1, 1).cwiseAbs();
  Stream stream({1, "moves", 0, 0, 0});
  move_group(
      u,
      [](const RowMatrix& at) -> Vector {
        return at.array().sqrt().isFinite().select(-at.col(0),
                                                   Vector::Constant(at.rows(), std::nan("")));
      },
      20, stream);
  EXPECT_GE(u.minCoeff(), 0.0);
  EXPECT_GT((u - random_matrix(100, 1, 1).cwiseAbs()).norm(), 1.0) << "somebody goes elsewhere";
  RowMatrix copies = RowMatrix::Zero(500, 2);
  move_group(copies, kStandardNormal, 30, stream);
  EXPECT_GT(copies.squaredNorm(), 0.0);
  RowMatrix few = RowMatrix::Ones(3, 2);
  move_group(few, kStandardNormal, 5, stream);
  EXPECT_EQ(few, RowMatrix::Ones(3, 2));
}

}  // namespace
}  // namespace npdr::inference
