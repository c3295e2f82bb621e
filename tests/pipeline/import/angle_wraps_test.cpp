#include "pipeline/import/angle_wraps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace npdr::pipeline {
namespace {

constexpr double kTurn = 2.0 * M_PI;

// An angle that turns at this rate a step, as a device gives it that wraps at half a turn.
Vector wrapped(double rate, Index count, double turn = kTurn) {
  Vector angle(count);
  for (Index t = 0; t < count; ++t) {
    angle(t) = std::remainder(rate * static_cast<double>(t) * turn, turn);
  }
  return angle;
}

std::vector<Index> rows_of(const Vector& angle, const std::string& unit = "rad") {
  return find_jumps(angle, unit).rows;
}

TEST(AngleWraps, AreFoundWhereTheAngleJumps) {
  EXPECT_EQ(rows_of(wrapped(0.11, 20)), (std::vector<Index>{4, 13}));
  EXPECT_EQ(rows_of(wrapped(-0.11, 20)), (std::vector<Index>{4, 13}));
  EXPECT_EQ(rows_of(wrapped(0.11, 20, 360.0), "deg"), (std::vector<Index>{4, 13}));
  EXPECT_TRUE(rows_of(wrapped(0.1, 20), "m").empty());
  EXPECT_TRUE(rows_of(Vector::Ones(1)).empty());
}

TEST(AngleWraps, NoiseAtTheEndOfATurnWrapsToAndFro) {
  const Vector balanced = (Vector(7) << 3.13, -3.14, 3.14, -3.13, -3.13, 3.14, 3.13).finished();
  EXPECT_EQ(rows_of(balanced), (std::vector<Index>{0, 1, 2, 4}));
}

TEST(AngleWraps, DegreesAreKnownByTheirJumps) {
  const AngleJumps jumps = find_jumps(wrapped(0.01, 200, 360.0), "rad");
  EXPECT_EQ(jumps.period, 360.0);
  EXPECT_EQ(jumps.rows.size(), 2u);
}

TEST(AngleWraps, NumbersThatStandForNoneAreNotJumpsOfATurn) {
  for (const double none : {-999.0, -9999.0, 1e6, 300.0, 99.0}) {
    Vector angle = wrapped(0.001, 200);
    angle(50) = none;
    angle.segment(120, 20).setConstant(none);
    EXPECT_TRUE(rows_of(angle).empty()) << none;
  }
}

TEST(AngleWraps, FastMotionIsNone) {
  for (const double rate : {0.2, 3.0, 5.0, 6.0, 20.0}) {  // 5 a step is likely in degrees
    Vector angle(40);
    for (Index t = 0; t < 40; ++t) angle(t) = rate * static_cast<double>(t);
    EXPECT_TRUE(rows_of(angle).empty()) << rate;
  }
}

TEST(AngleWraps, DifferencesOfAWrappedAngleSpike) {
  constexpr double dt = 0.01;
  const Vector angle = wrapped(0.03, 100);
  const Index n = angle.size();
  const Vector backward = (angle.tail(n - 1) - angle.head(n - 1)) / dt;
  const Vector central = (angle.tail(n - 2) - angle.head(n - 2)) / (2.0 * dt);
  EXPECT_EQ(find_jumps(angle, "rad").rows.size(), 3u);
  EXPECT_EQ(count_spikes(backward, dt, "rad"), 3);
  EXPECT_EQ(count_spikes(central, dt, "rad"), 6);
  EXPECT_EQ(count_spikes(backward, dt, "m"), 0);
  EXPECT_EQ(count_spikes(Vector::Constant(100, kTurn / dt), dt, "rad"), 0) << "a fast motion";
}

TEST(AngleWraps, UnwrappingTakesTheTurnsOut) {
  for (const double rate : {0.03, -0.1, 0.4}) {
    Vector angle = wrapped(rate, 50);
    EXPECT_GT(unwrap(angle, kTurn), 0);
    for (Index t = 0; t < 50; ++t) {
      EXPECT_NEAR(angle(t), rate * kTurn * static_cast<double>(t), 1e-12) << t;
    }
    EXPECT_EQ(unwrap(angle, kTurn), 0);
  }
}

TEST(AngleWraps, UnwrapsAColumnOfRows) {
  RowMatrix states = RowMatrix::Zero(20, 2);
  states.col(1) = wrapped(0.1, 20);
  EXPECT_EQ(unwrap(states.col(1), kTurn), 2);
  EXPECT_NEAR(states(19, 1), 1.9 * kTurn, 1e-12);
  EXPECT_TRUE(states.col(0).isZero(0.0));
}

}  // namespace
}  // namespace npdr::pipeline
