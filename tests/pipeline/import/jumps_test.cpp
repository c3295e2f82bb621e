// Steps that no motion makes.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "pipeline/import/jumps.h"
#include "tests/pipeline/import/encoder_motion.h"

namespace npdr::pipeline {
namespace {

Vector swing(Index n) {
  Vector values(n);
  for (Index t = 0; t < n; ++t) values(t) = 0.3 * std::cos(0.05 * static_cast<double>(t));
  return values;
}

// Of a few samples the second largest is usual: two on one side hide each other.
TEST(Glitches, AreSingleSamplesFarOut) {
  Vector values = swing(500);
  EXPECT_TRUE(find_glitches(values).empty());
  values(57) = 9999.0;
  values(201) = -4.0;
  values(202) = -4.0;  // two of them may be a motion
  values(300) = -2.0;
  EXPECT_EQ(find_glitches(values), (std::vector<Index>{57, 300}));
  values = swing(150);
  values(40) = 10.0;
  EXPECT_EQ(find_glitches(values), std::vector<Index>{40});
  values(90) = 10.0;
  EXPECT_TRUE(find_glitches(values).empty());
}

TEST(Glitches, StepsPulsesAndTheFirstSampleAreNone) {
  Vector step = Vector::Zero(100);
  step.tail(50).setConstant(5.0);
  EXPECT_TRUE(find_glitches(step).empty());
  Vector contact = Vector::Zero(200);
  for (Index t = 10; t < 200; t += 20) contact(t) = 1.0;
  EXPECT_TRUE(find_glitches(contact).empty());
  Vector still = Vector::Zero(200);
  still(100) = 1.0;  // nothing says what is usual
  EXPECT_TRUE(find_glitches(still).empty());
  Vector first = swing(100);
  first(0) = 100.0;
  EXPECT_TRUE(find_glitches(first).empty());
  EXPECT_TRUE(find_glitches(Vector::Zero(3)).empty());
}

// Encoders, tachometers and noise: no sample of 125 recordings.
TEST(Glitches, WhatLabsRecordHasNone) {
  for (std::uint64_t row = 1; row <= 25; ++row) {
    for (const Motion& motion : recorded(smooth_motion(1000, 0.004, row), row)) {
      EXPECT_TRUE(find_glitches(motion.position).empty()) << row;
      EXPECT_TRUE(find_glitches(motion.rate).empty()) << row;
    }
  }
}

// Of 20 samples that are missing, and of a sensor that stands still for 30.
TEST(LoneSteps, AreWhereSamplesAreMissingOrStoodStill) {
  const Vector all = swing(500);
  EXPECT_TRUE(find_lone_steps(all).empty());
  Vector missing(480);
  missing << all.head(88), all.tail(392);
  EXPECT_EQ(find_lone_steps(missing), std::vector<Index>{87});
  Vector still = all;
  still.segment(200, 30).setConstant(all(200));
  EXPECT_EQ(find_lone_steps(still), std::vector<Index>{229});
  EXPECT_EQ(find_lone_steps(rounded(still, 0.01)), std::vector<Index>{229}) << "by an encoder";
  still(400) += 0.2;
  EXPECT_EQ(find_lone_steps(still), (std::vector<Index>{229, 399, 400}));
}

TEST(LoneSteps, AreNoneOfRestsAndSlowEncoders) {
  Vector step = Vector::Zero(100);
  step.tail(50).setConstant(5.0);
  EXPECT_TRUE(find_lone_steps(step).empty()) << "it is all there is";
  EXPECT_TRUE(find_lone_steps(rounded(0.1 * swing(500), 0.01)).empty());
  EXPECT_TRUE(find_lone_steps(swing(29)).empty());
  Vector blow = 0.01 * swing(500);
  blow.tail(300).array() += 0.2;
  blow(199) += 0.1;
  EXPECT_TRUE(find_lone_steps(blow).empty()) << "two samples on end";
  for (std::uint64_t row = 1; row <= 25; ++row) {
    for (const Motion& motion : recorded(smooth_motion(1000, 0.004, row), row)) {
      EXPECT_TRUE(find_lone_steps(motion.position).empty()) << row;
    }
  }
}

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
  const Vector balanced = (Vector(7) << 3.13, -3.14, 3.14, -3.13, -3.13, 3.14, 3.13).finished();
  EXPECT_EQ(rows_of(balanced), (std::vector<Index>{0, 1, 2, 4}));
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
  RowMatrix states = RowMatrix::Zero(20, 2);
  states.col(1) = wrapped(0.1, 20);
  EXPECT_EQ(unwrap(states.col(1), kTurn), 2);
  EXPECT_NEAR(states(19, 1), 1.9 * kTurn, 1e-12);
  EXPECT_TRUE(states.col(0).isZero(0.0));
}

}  // namespace
}  // namespace npdr::pipeline
