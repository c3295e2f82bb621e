#include "sim/minigolf/arm.h"

#include <gtest/gtest.h>

#include <numbers>

namespace npdr::sim {
namespace {

void expect_near(const Eigen::Vector3d& found, const Eigen::Vector3d& expected, double tolerance) {
  EXPECT_LT((found - expected).norm(), tolerance)
      << found.transpose() << " and " << expected.transpose();
}

// The two ends of Table A4's strike, worked out with an independent program to a micrometer.
TEST(Arm, ReachesTheKnownPosesOfTheClubsHead) {
  expect_near(head_pose(strike(0.0)).translation(), {0.220000, 1.298015, 0.018699}, 1e-6);
  expect_near(head_pose(strike(0.5)).translation(), {0.547284, 1.297953, 0.085017}, 1e-6);
  expect_near(head_pose(strike(0.5)).linear().col(2), {0.9659258, 0.0, 0.2588190}, 1e-6);
}

TEST(Arm, PosesAreRigid) {
  for (double time = 0.0; time < 0.6; time += 0.05) {
    const Eigen::Matrix3d rotation = head_pose(strike(time)).linear();
    EXPECT_LT((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-13);
    EXPECT_NEAR(rotation.determinant(), 1.0, 1e-13);
  }
}

// Turning one joint alone moves the head on a circle about that joint's axis.
TEST(Arm, OneJointMovesTheHeadOnACircle) {
  for (std::size_t joint = 0; joint < kNumJoints; ++joint) {
    JointAngles q = strike(0.25);
    const Eigen::Isometry3d before = head_pose(q);
    q[joint] += 0.3;
    const Eigen::AngleAxisd turn(head_pose(q).linear() * before.linear().transpose());
    EXPECT_NEAR(turn.angle(), 0.3, 1e-12) << joint;
  }
}

TEST(Arm, TheStrikeEndsAfterHalfASecond) {
  EXPECT_EQ(strike(0.5), strike(7.0));
  const JointAngles begin = strike(0.0), end = strike(0.5), middle = strike(0.25);
  for (std::size_t j = 0; j < kNumJoints; ++j) {
    EXPECT_NEAR(middle[j], 0.5 * (begin[j] + end[j]), 1e-14);
  }
}

}  // namespace
}  // namespace npdr::sim
