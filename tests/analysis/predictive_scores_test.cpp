#include "analysis/predictive_scores.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "analysis/summary.h"
#include "core/constants.h"
#include "core/error.h"
#include "core/normal.h"
#include "core/random.h"
#include "tests/message_of.h"
#include "tests/thread_count.h"

namespace npdr::analysis {
namespace {

// The same observed value at all places of (H, T, C).
std::vector<RowMatrix> constant(Index rollouts, Index steps, Index channels, double y) {
  return std::vector<RowMatrix>(static_cast<std::size_t>(rollouts),
                                RowMatrix::Constant(steps, channels, y));
}

double brute_force_crps(const std::vector<double>& values, double y) {
  double error = 0.0, spread = 0.0;
  for (const double x : values) {
    error += std::abs(x - y);
    for (const double other : values) spread += std::abs(x - other);
  }
  const auto n = static_cast<double>(values.size());
  return error / n - spread / (2.0 * n * (n - 1.0));
}

// Eighths, some of them equal: all sums are exact.
TEST(Crps, EqualsTheSumOverAllPairs) {
  Stream stream({1, "predictive_scores_test"});
  for (const std::size_t n : {2, 3, 10, 33}) {
    std::vector<double> values(n);
    for (double& v : values) v = std::round(8.0 * stream.normal()) / 8.0;
    std::ranges::sort(values);
    for (const double y : {-100.0, -0.5, 0.125, 7.0, values[0]}) {
      EXPECT_EQ(crps_of_sorted(values, y), brute_force_crps(values, y)) << n << ' ' << y;
    }
  }
}

TEST(Crps, OfOneValueIsItsAbsoluteError) {
  EXPECT_EQ(crps_of_sorted(std::vector<double>{2.0}, 5.0), 3.0);
  EXPECT_TRUE(std::isnan(crps_of_sorted({}, 5.0)));
}

// One sample (H, T, C) = (2, 2, 2). Errors of channel 0: 1, 2 over 2 and 4, 0 over 4; of channel 1:
// 3, 3 over 1 and 0, 10 over 5.
TEST(PredictiveScores, CrpsOfOneSampleIsTheMeanAbsoluteErrorInUnitsOfTheAmplitude) {
  const std::vector<float> values = {1, 3, 2, -3, 14, 10, 10, 20};
  RowMatrix amplitude(2, 2);
  amplitude << 2, 1, 4, 5;
  const PredictiveScores scores = predictive_scores(
      {values, 1, 2, 2, 2}, {RowMatrix::Zero(2, 2), RowMatrix::Constant(2, 2, 10.0)}, amplitude);
  EXPECT_EQ(scores.num_samples, 1);
  EXPECT_DOUBLE_EQ(scores.crps(0), (0.5 + 1.0 + 1.0 + 0.0) / 4.0);
  EXPECT_DOUBLE_EQ(scores.crps(1), (3.0 + 3.0 + 0.0 + 2.0) / 4.0);
}

// 11 samples 0, ..., 10 of one rollout of 4 steps: bands of 50 % are [2.5, 7.5], their ends
// included, those of 90 % [0.5, 9.5]. Channel 1 is 100 times channel 0.
TEST(PredictiveScores, CoverageMatchesACaseWorkedByHand) {
  std::vector<float> values;
  for (const int k : {3, 0, 10, 7, 5, 1, 9, 2, 8, 4, 6}) {
    for (int t = 0; t < 4; ++t) {
      values.push_back(static_cast<float>(k));
      values.push_back(static_cast<float>(100 * k));
    }
  }
  RowMatrix observed(4, 2);
  observed << 2.5, 740, 9.4, 760, 9.6, 40, -20, 1e9;
  const RowMatrix coverage =
      predictive_scores({values, 11, 1, 4, 2}, {observed}, RowMatrix::Ones(1, 2), {0.9, 0.5})
          .coverage;
  RowMatrix expected(2, 2);
  expected << 0.5, 0.5, 0.25, 0.25;
  EXPECT_EQ(coverage, expected);
}

// Of white noise with these deviations (H, C).
ErrorDensity gaussian(const RowMatrix& deviation) {
  return [deviation](const SampledState& at, double error) {
    const double s = deviation(at.rollout, at.channel);
    return log_normal_density(error / s) - std::log(s);
  };
}

// (n, H, T, C) = (2, 1, 2, 2), deviations 1/2 and 4. Channel 0: samples 0 and 2 against 0, then
// both 1 against 2; channel 1: samples 8 and -8 against 0, then both 0 against 4.
TEST(LogScore, MatchesACaseWorkedByHand) {
  const std::vector<float> values = {0, 8, 1, 0, 2, -8, 1, 0};
  RowMatrix observed(2, 2), deviation(1, 2);
  observed << 0, 0, 2, 4;
  deviation << 0.5, 4.0;
  const Vector score = log_score({values, 2, 1, 2, 2}, {observed}, gaussian(deviation));
  const auto density = [](double u) { return std::exp(log_normal_density(u)); };
  const double first = std::log((density(0.0) + density(4.0)) / 2.0 / 0.5);
  const double second = log_normal_density(2.0) - std::log(0.5);
  ASSERT_EQ(score.size(), 2);
  EXPECT_NEAR(score(0), (first + second) / 2.0, 1e-14);
  EXPECT_NEAR(score(1), (log_normal_density(2.0) + log_normal_density(1.0)) / 2.0 - std::log(4.0),
              1e-14);
}

// The density of the nearer sample, 998 deviations away, is 0 in double precision.
TEST(LogScore, FarFromAllSamplesIsFinite) {
  const std::vector<float> values = {0, 2};
  const Vector score =
      log_score({values, 2, 1, 1, 1}, constant(1, 1, 1, 1000.0), gaussian(RowMatrix::Ones(1, 1)));
  EXPECT_DOUBLE_EQ(score(0), log_normal_density(998.0) - std::log(2.0));
}

TEST(PredictiveScores, LeaveOutFailedSamples) {
  const std::vector<float> all = {1, 2, 7, kFloatNaN, 4, 8, std::numeric_limits<float>::infinity(),
                                  0};
  const std::vector<float> usable = {1, 2, 4, 8};
  const std::vector<RowMatrix> observed = constant(1, 1, 2, 3.0);
  const RowMatrix ones = RowMatrix::Ones(1, 2);
  const PredictiveScores found = predictive_scores({all, 4, 1, 1, 2}, observed, ones);
  const PredictiveScores expected = predictive_scores({usable, 2, 1, 1, 2}, observed, ones);
  EXPECT_EQ(found.num_samples, 2);
  EXPECT_EQ(found.crps, expected.crps);
  EXPECT_EQ(found.coverage, expected.coverage);
  EXPECT_EQ(log_score({all, 4, 1, 1, 2}, observed, gaussian(ones)),
            log_score({usable, 2, 1, 1, 2}, observed, gaussian(ones)));
}

TEST(PredictiveScores, AreNanWhenEverySampleFailed) {
  const std::vector<float> values = {1, kFloatNaN, kFloatNaN, 2};
  const std::vector<RowMatrix> observed = constant(1, 1, 2, 0.0);
  const RowMatrix ones = RowMatrix::Ones(1, 2);
  const PredictiveScores scores = predictive_scores({values, 2, 1, 1, 2}, observed, ones);
  EXPECT_EQ(scores.num_samples, 0);
  EXPECT_TRUE(scores.crps.array().isNaN().all());
  EXPECT_TRUE(scores.coverage.array().isNaN().all());
  ASSERT_EQ(scores.coverage.rows(), 2);
  EXPECT_TRUE(log_score({values, 2, 1, 1, 2}, observed, gaussian(ones)).array().isNaN().all());
}

TEST(PredictiveScores, SameBitsForAnyThreadCount) {
  std::vector<float> values(50 * 2 * 30 * 3);
  Stream({4, "predictive_scores_test"}).fill_normal(values);
  const TrajectoryView view = {values, 50, 2, 30, 3};
  const std::vector<RowMatrix> observed = constant(2, 30, 3, 0.7);
  const RowMatrix scale = RowMatrix::Constant(2, 3, 0.3);
  expect_same_for_any_thread_count([&] {
    const PredictiveScores scores = predictive_scores(view, observed, scale);
    return std::tuple{scores.crps, scores.coverage, log_score(view, observed, gaussian(scale))};
  });
}

// White noise, of which the observation is one more draw: none of 100 samples is covered as seldom
// with a probability of 1 / 101. Of 1000 repetitions at most 26 are five standard errors (fixed
// seeds; false-alarm rate 1e-6). Bands without the observation would make it 56.
TEST(PredictiveScores, AnObservationThatIsOneMoreDrawIsHardlyEverCoveredLeast) {
  constexpr Index n = 100, steps = 100, channels = 2;
  std::vector<float> values((n + 1) * steps * channels);
  Index alarms = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Stream({5, "predictive_scores_test", i, 0, 0}).fill_normal(values);
    const TrajectoryView view = {std::span(values).first(n * steps * channels), n, 1, steps,
                                 channels};
    const RowMatrix last =
        Eigen::Map<const RowMatrixF>(values.data() + n * steps * channels, steps, channels)
            .cast<double>();
    const ComparedCoverage found = compare_coverage(view, {last}, 0.9);
    alarms += (found.samples.array() > found.observed).all() ? 1 : 0;
  }
  EXPECT_LE(alarms, 26);
  EXPECT_GT(alarms, 0);
}

TEST(PredictiveScores, SamplesThatFailedArentCompared) {
  std::vector<float> values(20 * 2 * 15 * 3);
  Stream({6, "predictive_scores_test"}).fill_normal(values);
  values[7 * 2 * 15 * 3] = kFloatNaN;
  const ComparedCoverage found =
      compare_coverage({values, 20, 2, 15, 3}, constant(2, 15, 3, 100.0), 0.8);
  EXPECT_EQ(found.num_samples, 19);
  EXPECT_TRUE(std::isnan(found.samples(7)));
  EXPECT_EQ(found.observed, 0.0);
  EXPECT_GT(found.samples(0), 0.5);
  EXPECT_EQ(
      compare_coverage({{&kFloatNaN, 1}, 1, 1, 1, 1}, constant(1, 1, 1, 0.0), 0.5).num_samples, 0);
}

TEST(PredictiveScores, RejectWhatCannotBeScored) {
  const std::vector<float> values(6), seven(7);
  const RowMatrix ones = RowMatrix::Ones(1, 2);
  const std::vector<RowMatrix> observed = constant(1, 3, 2, 0.0);
  // For 6 values as (n, H, T, C) = (1, 1, 3, 2).
  const auto score = [&](const std::vector<RowMatrix>& y, const RowMatrix& amplitude,
                         double level = 0.5) {
    return [&values, y, amplitude, level] {
      predictive_scores({values, 1, 1, 3, 2}, y, amplitude, {level});
    };
  };
  const auto expect = [](const std::string& message, const std::string& said) {
    EXPECT_TRUE(says(message, {"predictive scores: " + said}));
  };
  EXPECT_NO_THROW(score(observed, ones)());
  expect(message_of<ShapeError>(score(constant(2, 3, 2, 0.0), ones)),
         "2 observed rollouts, must be 1");
  expect(message_of<ShapeError>(score(constant(1, 2, 2, 0.0), ones)),
         "observed rollout 0 has shape (2, 2), must be (3, 2)");
  expect(message_of<ShapeError>(score(observed, RowMatrix::Ones(2, 2))),
         "amplitude has shape (2, 2), must be (1, 2)");
  expect(message_of<InputError>(score(constant(1, 3, 2, kNaN), ones)), "observed rollout 0");
  expect(message_of<InputError>(score(observed, RowMatrix{{1.0, 0.0}})),
         "amplitude of channel 1 in rollout 0 = 0, must be finite and > 0");
  expect(message_of<InputError>(score(observed, ones, 1.0)),
         "level of a band = 1, must be in (0, 1)");
  EXPECT_THROW(predictive_scores({seven, 1, 1, 3, 2}, observed, ones), ShapeError);
  EXPECT_THROW(log_score({seven, 1, 1, 3, 2}, observed, gaussian(ones)), ShapeError);
}

}  // namespace
}  // namespace npdr::analysis
