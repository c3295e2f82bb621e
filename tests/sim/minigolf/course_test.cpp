#include "sim/minigolf/course.h"

#include <gtest/gtest.h>

#include <cmath>

namespace npdr::sim {
namespace {

Eigen::RowVectorXd nominal() {
  const std::vector<Parameter> parameters = course_parameters();
  Eigen::RowVectorXd theta(static_cast<Index>(parameters.size()));
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    theta(static_cast<Index>(p)) = parameters[p].nominal;
  }
  return theta;
}

TEST(Course, DistanceFromABoxIsThatOfItsFootprint) {
  const CourseBox box = {0.3, 0.1, 0.1, 1.0, 2.0, 0.0};
  EXPECT_DOUBLE_EQ(Footprint(box).distance(1.0, 2.0), 0.0);
  EXPECT_DOUBLE_EQ(Footprint(box).distance(1.5, 2.0), 0.2);
  EXPECT_DOUBLE_EQ(Footprint(box).distance(1.0, 1.5), 0.4);
  EXPECT_DOUBLE_EQ(Footprint(box).distance(1.6, 2.5), 0.5);
}

TEST(Course, ABallAtTheNominalStartIsFreeAtNominalParameters) {
  EXPECT_FALSE(begins_inside(course_at(nominal()), kBallStartX, kBallStartY));
}

TEST(Course, ABallThatTouchesAnObstacleBeginsInside) {
  Course course = course_at(nominal());
  const CourseBox& box = course.obstacles[0];
  // Beside the middle of its long side; the ball is higher than the box, so the edge counts.
  const double across = box.half_y + course.ball_radius;
  const auto beside = [&](double gap) {
    return begins_inside(course, box.x - std::sin(box.yaw) * (across + gap),
                         box.y + std::cos(box.yaw) * (across + gap));
  };
  EXPECT_TRUE(beside(-1e-3));
  EXPECT_FALSE(beside(1e-6));
  course.ball_radius = 0.05;  // 20 mm above the edge: it reaches sqrt(50^2 - 20^2) mm far
  EXPECT_TRUE(begins_inside(course, box.x - std::sin(box.yaw) * (box.half_y + 0.045),
                            box.y + std::cos(box.yaw) * (box.half_y + 0.045)));
  EXPECT_FALSE(begins_inside(course, box.x - std::sin(box.yaw) * (box.half_y + 0.047),
                             box.y + std::cos(box.yaw) * (box.half_y + 0.047)));
}

TEST(Course, ABallInABoundBeginsInside) {
  const Course course = course_at(nominal());
  const CourseBox& bound = bounds()[0];
  EXPECT_TRUE(begins_inside(course, bound.x, bound.y - bound.half_y - 0.019));
  EXPECT_FALSE(begins_inside(course, bound.x, bound.y - bound.half_y - 0.021));
}

TEST(Course, OffsetsCountFromTheNominalPoses) {
  Eigen::RowVectorXd theta = nominal();
  theta.segment(4, 6) << 0.01, 0.02, 0.03, 0.04, 0.5, 0.6;  // dx1 dy1 dx2 dy2 dyaw1 dyaw2
  const Course before = course_at(nominal()), after = course_at(theta);
  EXPECT_NEAR(after.obstacles[0].x - before.obstacles[0].x, 0.01, 1e-15);
  EXPECT_NEAR(after.obstacles[0].y - before.obstacles[0].y, 0.02, 1e-15);
  EXPECT_NEAR(after.obstacles[1].x - before.obstacles[1].x, 0.03, 1e-15);
  EXPECT_NEAR(after.obstacles[1].y - before.obstacles[1].y, 0.04, 1e-15);
  EXPECT_NEAR(after.obstacles[0].yaw - before.obstacles[0].yaw, 0.5, 1e-15);
  EXPECT_NEAR(after.obstacles[1].yaw - before.obstacles[1].yaw, 0.6, 1e-15);
}

}  // namespace
}  // namespace npdr::sim
