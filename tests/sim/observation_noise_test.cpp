#include "sim/observation_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/constants.h"
#include "core/error.h"

namespace npdr::sim {
namespace {

Stream noise_stream() { return Stream({1, "observation_noise", 1, 5, 0}); }

// Two rollouts of two channels.
RowMatrix amplitudes() {
  RowMatrix amplitude(2, 2);
  amplitude << 1.0, 10.0, 2.0, 0.0;
  return amplitude;
}

TEST(ObservationNoise, ReferenceAmplitudeIsTheLargestStateAfterTheFirst) {
  Target target;
  target.state_channels = {{"theta", "rad"}, {"theta_dot", "rad/s"}};
  RowMatrix states(3, 2);
  states << 9.0, 9.0, 1.0, -4.0, -2.0, 3.0;
  target.rollouts = {{"a", states, RowMatrix::Zero(2, 1)},
                     {"b", 10.0 * states, RowMatrix::Zero(2, 1)}};
  RowMatrix expected(2, 2);
  expected << 2.0, 4.0, 20.0, 40.0;
  EXPECT_EQ(reference_amplitude(target), expected);
}

TEST(ObservationNoise, HasTheStandardDeviationOfEveryRolloutAndChannel) {
  constexpr Index steps = 20'000;
  std::vector<float> series(2 * steps * 2, 0.0f);
  Stream stream = noise_stream();
  add_observation_noise(series, 0.3 * amplitudes(), stream);
  for (Index h = 0; h < 2; ++h) {
    for (Index c = 0; c < 2; ++c) {
      double squares = 0.0;
      for (Index t = 0; t < steps; ++t) {
        squares += std::pow(series[static_cast<std::size_t>((h * steps + t) * 2 + c)], 2);
      }
      const double expected = 0.3 * amplitudes()(h, c);
      // Standard error of a standard deviation: s / sqrt(2 n); five of them, and the seed is fixed.
      EXPECT_NEAR(std::sqrt(squares / steps), expected,
                  5.0 * expected / std::sqrt(2.0 * static_cast<double>(steps)));
    }
  }
}

TEST(ObservationNoise, IsAddedToTheSeriesAndAFunctionOfTheStream) {
  std::vector<float> series(3000, 7.0f), noise(3000, 0.0f);
  Stream stream = noise_stream(), same = noise_stream();
  add_observation_noise(series, 0.1 * amplitudes(), stream);
  add_observation_noise(noise, 0.1 * amplitudes(), same);
  for (std::size_t i = 0; i < series.size(); ++i) EXPECT_FLOAT_EQ(series[i], 7.0f + noise[i]);
}

TEST(ObservationNoise, OfScaleZeroChangesNothingAndNanStaysNan) {
  std::vector<float> series(8, 1.5f);
  series[2] = kFloatNaN;
  Stream stream = noise_stream();
  add_observation_noise(series, 0.0 * amplitudes(), stream);
  EXPECT_EQ(series[0], 1.5f);
  EXPECT_TRUE(std::isnan(series[2]));
}

TEST(ObservationNoise, RejectsASeriesOfAnotherShape) {
  std::vector<float> series(6);
  Stream stream = noise_stream();
  EXPECT_THROW(add_observation_noise(series, 0.1 * amplitudes(), stream), ShapeError);
}

}  // namespace
}  // namespace npdr::sim
