#include "sim/error_memory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "sim/noise_likelihood.h"

namespace npdr::sim {
namespace {

// Draws of an autoregressive process of variance 1, a channel.
RowMatrix series_of(double correlation, Index n, std::uint64_t seed) {
  Stream stream({seed, "error_memory_test", 0, 0, 0});
  RowMatrix z(n, 1);
  double last = stream.normal();
  for (Index k = 0; k < n; ++k) {
    z(k, 0) = last;
    last = correlation * last + std::sqrt(1.0 - correlation * correlation) * stream.normal();
  }
  return z;
}

std::vector<char> one_segment(Index n) {
  std::vector<char> restarts(static_cast<std::size_t>(n), 0);
  restarts.front() = 1;
  return restarts;
}

// tau = (1 + rho) / (1 - rho). Of 40,000 draws its standard error is some 3 %.
TEST(ErrorMemory, OfAnAutoregressiveProcessIsItsCorrelationTime) {
  const Index n = 40'000;
  EXPECT_NEAR(memory_of(series_of(0.0, n, 1), one_segment(n)).memory(0), 1.0, 0.06);
  EXPECT_NEAR(memory_of(series_of(0.6, n, 2), one_segment(n)).memory(0), 4.0, 0.5);
  EXPECT_NEAR(memory_of(series_of(0.9, n, 3), one_segment(n)).memory(0), 19.0, 3.0);
}

TEST(ErrorMemory, EndsWithItsSegment) {
  const Index n = 40'000;
  std::vector<char> restarts(static_cast<std::size_t>(n));
  for (std::size_t k = 0; k < restarts.size(); ++k) restarts[k] = k % 4 == 0;
  const double found = memory_of(series_of(0.9, n, 4), restarts).memory(0);
  // 1 + 2 sum_l (1 - l / 4) rho^l, l = 1, 2, 3
  EXPECT_NEAR(found, 1.0 + 2.0 * (0.75 * 0.9 + 0.5 * 0.81 + 0.25 * 0.729), 0.15);
}

TEST(ErrorMemory, NamesTheChannelOfTheLargestExcess) {
  RowMatrix z(1000, 2);
  z.col(0) = series_of(0.0, 1000, 5);
  z.col(1) = 2.0 * series_of(0.0, 1000, 6);
  const ErrorMemory found = memory_of(z, one_segment(1000));
  EXPECT_EQ(found.worst_channel(), 1);
  EXPECT_NEAR(found.size(1), 4.0, 0.8);
  EXPECT_DOUBLE_EQ(found.excess(), found.size(1) * found.memory(1));
}

TEST(ErrorMemory, OfNothingIsOne) {
  EXPECT_EQ(memory_of(RowMatrix::Zero(10, 1), one_segment(10)).memory(0), 1.0);
}

// Of independent errors of the right size hardly any are accused, in any of several channels.
TEST(ErrorMemory, HardlyAccusesIndependentErrors) {
  constexpr int kTrials = 2000;
  for (const Index num_channels : {1, 12}) {
    for (const Index n : {10, 50, 150, 500}) {
      int accused = 0;
      for (std::uint64_t seed = 0; seed < kTrials; ++seed) {
        RowMatrix z(n, num_channels);
        for (Index c = 0; c < num_channels; ++c) {
          z.col(c) = series_of(0.0, n, 100 + 20 * seed + static_cast<std::uint64_t>(c));
        }
        const ErrorMemory found = memory_of(z, one_segment(n));
        accused += found.excess() > largest_by_chance(n, num_channels) ? 1 : 0;
      }
      EXPECT_LE(accused, kTrials / 200) << n << " of " << num_channels;
    }
  }
}

ErrorMemory memory_at_zero(const ChannelNoise& noise, const ChannelNoise& assumed) {
  const Index n = 2000;
  const auto model_of = [&](const ChannelNoise& its) {
    return NoiseModel({its}, RowMatrix::Ones(2, 1), stored_restarts(n, 0, 1));
  };
  std::vector<float> recorded(2 * n, 0.0f);
  Stream stream({7, "error_memory_test", 0, 0, 0});
  model_of(noise).add(recorded, 1, stream);
  return NoiseLikelihood(model_of(assumed), recorded)
      .error_memory(std::vector<float>(recorded.size(), 0.0f));
}

// Noise that is what the model says leaves no memory and the size 1, and other noise does. Of 4000
// errors either has a standard error of 4 % at most.
TEST(ErrorMemory, IsOfWhatTheNoiseLeaves) {
  const ChannelNoise white = {.scale = {0.2, 1.0}};
  ChannelNoise correlated = white;
  correlated.is_correlated = true;
  correlated.correlation = {0.7, 1.5};
  ChannelNoise heavy = white;
  heavy.is_heavy_tailed = true;
  heavy.degrees_of_freedom = {3.0, 1.0};
  for (const ChannelNoise& noise : {white, correlated, heavy}) {
    const ErrorMemory found = memory_at_zero(noise, noise);
    EXPECT_NEAR(found.memory(0), 1.0, 0.16);
    EXPECT_NEAR(found.size(0), 1.0, 0.16);
  }
  EXPECT_GT(memory_at_zero(correlated, white).excess(), 2.0);
  EXPECT_GT(memory_at_zero({.scale = {0.2}}, {.scale = {0.1}}).excess(), 3.0);
}

}  // namespace
}  // namespace npdr::sim
