#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "pipeline/predictions/left_out.h"
#include "pipeline/predictions/prediction.h"
#include "pipeline/predictions/scores.h"

namespace npdr::pipeline {
namespace {

// Two samples, the second of which has failed, of one channel.
class InferredNoises : public ::testing::Test {
 protected:
  InferredNoises() {
    seen_.resize(2, 1, 3, 1);
    seen_.status = {sim::RolloutStatus::ok, sim::RolloutStatus::diverged};
  }

  std::optional<InferredNoise> of(const sim::ChannelNoise& noise) const {
    const sim::NoiseModel model({noise}, RowMatrix::Ones(1, 1), std::vector<char>{1, 0, 0});
    return inferred_noise(model, {{{0.2, 0.5, 4.0}}, {{0.3, 0.6, 5.0}}}, seen_);
  }

  sim::Trajectories seen_;
};

TEST_F(InferredNoises, AreNotThoseOfSamplesThatFailed) {
  const auto inferred = of({.scale = {0.2, 1.0},
                            .is_correlated = true,
                            .correlation = {0.5, 1.0},
                            .is_heavy_tailed = true,
                            .degrees_of_freedom = {4.0, 1.0}});
  ASSERT_TRUE(inferred.has_value());
  EXPECT_EQ(inferred->scale(0, 0), 0.2);
  EXPECT_EQ(inferred->correlation(0, 0), 0.5);
  EXPECT_EQ(inferred->degrees_of_freedom(0, 0), 4.0);
  for (const RowMatrix* values :
       {&inferred->scale, &inferred->correlation, &inferred->degrees_of_freedom}) {
    EXPECT_TRUE(std::isnan((*values)(1, 0)));
  }
}

TEST_F(InferredNoises, AreThereWhereAnyParameterIsUnknown) {
  EXPECT_FALSE(of({.scale = {0.2, 0.0}}).has_value());
  const auto white = of({.scale = {0.2, 1.0}});
  ASSERT_TRUE(white.has_value());
  EXPECT_EQ(white->correlation.size(), 0);
  EXPECT_EQ(white->degrees_of_freedom.size(), 0);
}

constexpr Index kRollouts = 3, kSteps = 200;

// One channel of amplitude 1 with white noise of an unknown scale.
sim::NoiseModel model_of(double deviation) {
  return {{{.scale = {0.2, deviation}}},
          RowMatrix::Ones(kRollouts, 1),
          sim::stored_restarts(kSteps, 10, 1)};
}

// N(0, deviation^2) at every state.
std::vector<float> white(double deviation, std::uint64_t row) {
  std::vector<float> series(static_cast<std::size_t>(kRollouts * kSteps));
  Stream stream({1, "test", row, 0, 0});
  for (float& value : series) value = static_cast<float>(deviation * stream.normal());
  return series;
}

LeftOutScore score_of(double spread_of_rows, double prior_deviation,
                      const std::vector<float>& recorded = white(0.2, 0),
                      const std::vector<float>& first_row = {}) {
  constexpr Index count = 400;
  sim::Trajectories rows;
  rows.resize(count, kRollouts, kSteps, 1);
  for (Index i = 0; i < count; ++i) {
    std::ranges::copy(white(spread_of_rows, static_cast<std::uint64_t>(i + 1)),
                      rows.row(i).begin());
    rows.status[static_cast<std::size_t>(i)] = sim::RolloutStatus::ok;
  }
  std::ranges::copy(first_row, rows.row(0).begin());
  return left_out_score(sim::NoiseLikelihood(model_of(prior_deviation), recorded), recorded, rows,
                        Vector::Ones(count), 0.0, {1, "test", 0, 0, 0});
}

// The 600 errors know their scale to 3 %, and the score of a factor of sqrt(2) is 2.4 % more.
TEST(LeftOut, NoiseThatNothingElseExplainsIsKept) {
  const LeftOutScore score = score_of(0.0, 1.0);
  EXPECT_EQ(score.noise_factor, 1.0);
  EXPECT_NEAR(score.crps.mean(), 0.2 / std::sqrt(std::numbers::pi), 0.015) << "a tenth: 3 errors";
}

// Rows that are as far from each other as from the recording predict it alone.
TEST(LeftOut, NoiseThatRowsShowThemselvesIsLess) {
  const LeftOutScore score = score_of(0.2, 1.0);
  EXPECT_LE(score.noise_factor, 0.5);
  EXPECT_NEAR(score.crps.mean(), 0.2 / std::sqrt(std::numbers::pi), 0.015);
  EXPECT_EQ(score_of(0.2, 0.0).noise_factor, 1.0) << "a scale that is given";
}

// Every fifth error has a deviation of 0.5, others of 0.1; together of 0.24. By the integrals of
// normal distributions, factors of 1/2, 0.71 and 1 have scores in the ratio of 1, 1.002 and 1.045,
// and bands that hold .82, .88 and .91.
TEST(LeftOut, OfNoisesThatScoreAlikeTheOneWithTheRightBandsIsTaken) {
  std::vector<float> recorded = white(0.1, 0);
  for (std::size_t i = 0; i < recorded.size(); i += 5) recorded[i] *= 5.0F;
  EXPECT_EQ(score_of(0.0, 1.0, recorded).noise_factor, 0.70711);
}

// A row that is off by 0.02 says that noise is that small; the others, which predict the recording
// with it, are off by 1.4.
TEST(LeftOut, WhereNoiseHardlyMattersItIsKept) {
  std::vector<float> near = white(0.02, 1000);
  const std::vector<float> recorded = white(1.0, 0);
  std::ranges::transform(near, recorded, near.begin(), std::plus());
  EXPECT_EQ(score_of(1.0, 1.0, recorded, near).noise_factor, 1.0);
}

using inference::Marginal;

TEST(SearchBox, IsThePriorInsideOfWhatIsPossible) {
  const auto simulator = sim::make_simulator({.name = "pendulum"});
  const SearchBox box = search_box({{"pole_mass", "kg", Marginal::Kind::uniform, 0.3, 1.7},
                                    {"pole_length", "m", Marginal::Kind::log_uniform, 0.1, 2.0},
                                    {"gravity", "m/s^2", Marginal::Kind::normal, 9.0, 0.5},
                                    {"damping", "N m s/rad", Marginal::Kind::normal, 0.33, 0.1}},
                                   simulator->info());
  EXPECT_EQ(box.lower, (Vector{{0.3, 0.1, 7.0, 0.0}})) << "no negative damping";
  EXPECT_EQ(box.upper, (Vector{{1.7, 2.0, 11.0, 0.33 + 4.0 * 0.1}}));
  const SearchBox log_normal =
      search_box({{"pole_mass", "kg", Marginal::Kind::log_normal, 0.0, 0.25}}, simulator->info());
  EXPECT_DOUBLE_EQ(log_normal.lower(0), std::exp(-1.0));
  EXPECT_DOUBLE_EQ(log_normal.upper(0), std::exp(1.0));
}

}  // namespace
}  // namespace npdr::pipeline
