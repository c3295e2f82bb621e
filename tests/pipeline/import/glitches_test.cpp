#include "pipeline/import/glitches.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/pipeline/import/encoder_motion.h"

namespace npdr::pipeline {
namespace {

Vector swing(Index n) {
  Vector values(n);
  for (Index t = 0; t < n; ++t) values(t) = 0.3 * std::cos(0.05 * static_cast<double>(t));
  return values;
}

TEST(Glitches, AreSingleSamplesFarOut) {
  Vector values = swing(500);
  EXPECT_TRUE(find_glitches(values).empty());
  values(57) = 9999.0;
  values(201) = -4.0;
  values(202) = -4.0;  // two of them may be a motion
  values(300) = -2.0;
  EXPECT_EQ(find_glitches(values), (std::vector<Index>{57, 300}));
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

// Of a few samples the second largest is usual.
TEST(Glitches, TwoOnOneSideOfAShortRolloutHideEachOther) {
  Vector values = swing(150);
  values(40) = 10.0;
  EXPECT_EQ(find_glitches(values), std::vector<Index>{40});
  values(90) = 10.0;
  EXPECT_TRUE(find_glitches(values).empty());
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

}  // namespace
}  // namespace npdr::pipeline
