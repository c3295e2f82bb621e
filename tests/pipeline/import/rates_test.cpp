#include "pipeline/import/rates.h"

#include <cmath>

#include "sim/savitzky_golay.h"
#include "tests/message_of.h"
#include "tests/pipeline/import/encoder_motion.h"

namespace npdr::pipeline {
namespace {

constexpr double kDt = 0.004;                   // [s]
constexpr double kCount = 2.0 * M_PI / 2048.0;  // of an encoder [rad]

Target recording_of(const Vector& position) {
  Target target;
  target.dt = kDt;
  target.state_channels = {{"angle", "rad"}, {"angle_dot", "rad/s"}};
  Rollout rollout{"a", RowMatrix::Zero(position.size(), 2), RowMatrix(position.size() - 1, 0)};
  rollout.states.col(0) = position;
  target.rollouts = {rollout};
  return target;
}

struct Computed {
  Vector rates;
  std::vector<std::string> notes;
};

Computed computed(const Vector& position, Index window, bool at_rest = false) {
  Target target = recording_of(position);
  std::vector<std::string> notes = texts_of(compute_rates(target, {{0, 1}}, {window, at_rest}));
  return {target.rollouts[0].states.col(1), std::move(notes)};
}

// A motor of 100 rad/s and 30 ms whose voltage is switched on at 0.
Vector switched_on() {
  Vector position(250);
  for (Index t = 0; t < position.size(); ++t) {
    const double time = kDt * static_cast<double>(t);
    position(t) = 100.0 * (time - 0.03 * (1.0 - std::exp(-time / 0.03)));
  }
  return position;
}

// Bounces from 0 at 0.4 s.
Vector bounced() {
  Vector position(250);
  for (Index t = 0; t < position.size(); ++t) {
    position(t) = std::abs(kDt * static_cast<double>(t) - 0.4);
  }
  return position;
}

TEST(ComputedRates, AreSlopesOfPositions) {
  const Vector position = smooth_motion(500, kDt, 1).position;
  const Computed result = computed(position, 11);
  EXPECT_EQ(result.rates, sim::slopes(position, 11, kDt));
  ASSERT_EQ(result.notes.size(), 1u);
  EXPECT_TRUE(
      says(result.notes[0], {"computed angle_dot: slope of angle over 11 samples, 0.04 s"}));
  EXPECT_EQ(computed(position, 11, true).rates(0), 0.0);
}

TEST(ComputedRates, TellWhereThePositionBendsTooMuch) {
  const Computed result = computed(switched_on(), 11);
  ASSERT_EQ(result.notes.size(), 2u);
  EXPECT_GT(std::abs(result.rates(0)), 3.0) << "it stood still";
  EXPECT_TRUE(says(result.notes[1], {"warning: a: angle_dot may be off by",
                                     "[rad/s] in row 1:", "angle bends too much for 11 samples",
                                     "--differentiate=7", "--at-rest"}));
  EXPECT_EQ(computed(rounded(switched_on(), kCount), 11).notes.size(), 2u) << "by an encoder";
  EXPECT_EQ(computed(switched_on(), 7).notes.size(), 1u) << "what it advises ends it";
  const Computed later = computed(with_noise(bounced(), 1e-5, 1), 11);
  ASSERT_EQ(later.notes.size(), 2u);
  EXPECT_TRUE(says(later.notes[1], {"warning: a: angle_dot may be off by", "in row 100"}));
  EXPECT_FALSE(has(later.notes[1], "--at-rest"));
  EXPECT_EQ(computed(switched_on(), 5).notes.size(), 1u) << "there is no shorter one";
}

TEST(ComputedRates, TellWhichSampleIsWrongOrRepeated) {
  const Motion motion = smooth_motion(500, kDt, 1);
  Index fast = 0;
  motion.rate.segment(50, 400).cwiseAbs().maxCoeff(&fast);
  const Index t = fast + 50;
  for (const double wrong : {motion.position(t) + 0.05, motion.position(t - 1)}) {
    Vector recorded = motion.position;
    recorded(t) = wrong;
    const Computed result = computed(recorded, 11);
    ASSERT_EQ(result.notes.size(), 2u);
    const std::string words = result.notes[1], place = "in row ";
    ASSERT_TRUE(has(words, "a sample near it is wrong, missing or repeated")) << words;
    const std::size_t row = words.find(place) + place.size();
    EXPECT_NEAR(std::stoi(words.substr(row)), static_cast<int>(t) + 1, 1);
  }
}

// Five counts a sample, without any other step; a motion without noise.
TEST(ComputedRates, TellWhatBouncesOffWithoutNoise) {
  Vector position(250);
  for (Index t = 0; t < position.size(); ++t) {
    position(t) = 5.0 * kCount * std::abs(static_cast<double>(t - 100));
  }
  EXPECT_EQ(computed(position, 11).notes.size(), 2u);
  EXPECT_EQ(computed(smooth_motion(250, kDt, 1).position + position, 11).notes.size(), 2u);
}

TEST(ComputedRates, NameTheFileThatBends) {
  Target target = recording_of(smooth_motion(250, kDt, 1).position);
  target.rollouts.push_back(recording_of(switched_on()).rollouts[0]);
  target.rollouts[1].name = "b";
  const std::vector<std::string> notes = texts_of(compute_rates(target, {{0, 1}}, RateOptions{}));
  ASSERT_EQ(notes.size(), 2u);
  EXPECT_TRUE(says(notes[1], {"warning: b: angle_dot may be off by", "in row 1:"}));
  EXPECT_EQ(compute_rates(target, {{0, 1}}, {.at_rest = true}).size(), 2u)
      << "the samples after the first are off as well";
}

// False alarms: differences of white noise reach 1.2 sigma / dt in one deviation, so those of a
// sample in 1e8; sigma itself is known to a fifth.
TEST(ComputedRates, SayNothingOfNoiseAndCounts) {
  for (std::uint64_t row = 0; row < 40; ++row) {
    const Vector position = smooth_motion(1000, kDt, row).position;
    Vector partly = position;
    partly.tail(400) = with_noise(position.tail(400), 1e-3, row);
    for (const Vector& recorded :
         {position, rounded(position, kCount), with_noise(position, 2e-3, row), partly}) {
      EXPECT_EQ(computed(recorded, 11).notes.size(), 1u) << row;
    }
  }
}

TEST(ComputedRates, SayNothingOfCountsAtASteadySpeed) {
  for (const double speed : {0.9, 0.97, 1.03, 2.95, 5.02}) {  // counts a sample
    const Vector position = Vector::LinSpaced(500, 0.0, 499.0 * speed * kCount);
    const Vector counts = rounded(position, kCount);
    const Vector far = counts.array() + 4.5e6;  // rounding of large numbers is no count
    for (const Vector& recorded : {counts, far, rounded(counts, 1e-9), rounded(counts, 1e-12)}) {
      EXPECT_EQ(computed(recorded, 11).notes.size(), 1u) << speed;
    }
  }
}

TEST(ComputedRates, LeaveOutWhatWasResampled) {
  Target target = recording_of(switched_on());
  EXPECT_EQ(compute_rates(target, {{0, 1}}, {.is_resampled = true}).size(), 1u);
  EXPECT_EQ(computed(Vector::Constant(250, 0.5), 11).notes.size(), 1u) << "it stands still";
}

}  // namespace
}  // namespace npdr::pipeline
