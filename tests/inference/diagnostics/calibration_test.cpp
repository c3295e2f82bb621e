#include "inference/diagnostics/calibration.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "inference/diagnostics/coverage.h"
#include "inference/diagnostics/sbc.h"
#include "tests/inference/diagnostics/exact_posterior.h"

namespace npdr::inference {
namespace {

constexpr Index kNumCalibrations = 300;
const StreamId kCalibrationId{1, "", 0, 0, 0};

struct Verdicts {
  Sbc sbc;
  Coverage density;
  Coverage distance;
  double mean_log_prob = 0.0;
};

Vector spread(const VectorX<std::int64_t>& ranks, Index num_samples, std::string_view name) {
  return spread_ranks({ranks.begin(), ranks.end()}, num_samples, {1, name, 0, 0, 0});
}

Verdicts judge(const Fault& fault) {
  const LinearGaussian task(2);
  const RowMatrix theta = sample_prior(task.prior(), kNumCalibrations, 1);
  const RowMatrixF x = simulate(task.simulator(), theta, 1, 1);
  const CalibrationRanks ranks =
      rank_truths(amortized(task, fault), theta, x, {.num_samples = 200}, kCalibrationId);
  RowMatrix of_parameters(kNumCalibrations, 2);
  of_parameters << spread(ranks.parameter.col(0), 200, "first"),
      spread(ranks.parameter.col(1), 200, "second");
  return {test_sbc(of_parameters), measure_coverage(spread(ranks.density, 200, "density")),
          measure_coverage(spread(ranks.distance, 200, "distance")), ranks.log_prob.mean()};
}

// Each p-value is below 1 % in 1 % of all seeds; three of them, a fixed seed.
TEST(Calibration, TheExactPosteriorPasses) {
  const Verdicts found = judge({});
  EXPECT_GT(found.sbc.p_value, 0.01);
  EXPECT_GT(found.density.kolmogorov_smirnov.p_value, 0.01);
  EXPECT_GT(found.distance.kolmogorov_smirnov.p_value, 0.01);
}

// In D = 2 the highest density region of level c of a Gaussian that is w times as wide as the right
// one has coverage 1 - (1 - c)^(w^2).
TEST(Calibration, CoverageOfAWrongWidthIsKnown) {
  for (const double width : {0.6, 1.0, 1.6}) {
    const Coverage found = judge({.width = width}).density;
    for (Index i = 10; i < 100; i += 20) {
      const double expected = 1.0 - std::pow(1.0 - found.level(i), width * width);
      // Four standard errors (false-alarm rate 6e-5 each), and the ranks' own width.
      const double error = std::sqrt(expected * (1.0 - expected) / kNumCalibrations);
      EXPECT_NEAR(found.coverage(i), expected, 4.0 * error + 0.005) << width << ' ' << i;
    }
  }
}

// Of a Gaussian in D = 2 that is w times as wide as the right one, whose covariance is S: the mean
// of log q(theta) is -log 2 pi - log|S| / 2 - 2 log w - 1 / w^2.
TEST(Calibration, TheDensityOfTruthsIsKnown) {
  const double half_log_det = 0.5 * std::log(LinearGaussian(2).covariance().determinant());
  for (const double w : {0.6, 1.0, 1.6}) {
    const double expected =
        -std::log(2.0 * M_PI) - half_log_det - 2.0 * std::log(w) - 1.0 / (w * w);
    // Four standard errors of an exponential variable over w^2 (false-alarm rate 6e-5 each).
    const double error = 1.0 / (w * w) / std::sqrt(static_cast<double>(kNumCalibrations));
    EXPECT_NEAR(judge({.width = w}).mean_log_prob, expected, 4.0 * error) << w;
  }
}

TEST(Calibration, AWrongWidthFailsEveryCheck) {
  for (const double width : {0.6, 1.6}) {
    const Verdicts found = judge({.width = width});
    EXPECT_LT(found.sbc.p_value, 1e-3) << width;
    EXPECT_LT(found.density.kolmogorov_smirnov.p_value, 1e-3) << width;
    EXPECT_LT(found.distance.kolmogorov_smirnov.p_value, 1e-3) << width;
    EXPECT_EQ(found.density.area > 0.0, width > 1.0);
    EXPECT_EQ(found.distance.area > 0.0, width > 1.0);
  }
}

TEST(Calibration, ASimulationDependsOnItsOwnNumberAlone) {
  const LinearGaussian task(2);
  const RowMatrix theta = sample_prior(task.prior(), 10, 1);
  const RowMatrixF x = simulate(task.simulator(), theta, 1, 1);
  const CalibrationRanks none{.num_samples = 50};
  const CalibrationRanks all = rank_truths(amortized(task), theta, x, none, kCalibrationId);
  const CalibrationRanks some =
      rank_truths(amortized(task), theta.topRows(4), x.topRows(4), none, kCalibrationId);
  EXPECT_EQ(some.num_done, 4);
  EXPECT_EQ(some.parameter, all.parameter.topRows(4));
  EXPECT_EQ(some.density, all.density.head(4));
  EXPECT_EQ(some.distance, all.distance.head(4));
  EXPECT_EQ(some.theta, all.theta.topRows(4));
  EXPECT_EQ(some.log_prob, all.log_prob.head(4));
  EXPECT_NE(all.theta.row(0), all.theta.row(1));
  EXPECT_THROW(rank_truths(amortized(task), theta, x.topRows(3), none, kCalibrationId), ShapeError);
  EXPECT_THROW(rank_truths(amortized(task), theta.topRows(3), x.topRows(3), some, kCalibrationId),
               ShapeError)
      << "more are done than there are";
}

TEST(Calibration, GoesOnWithTheSameBits) {
  const LinearGaussian task(2);
  const RowMatrix theta = sample_prior(task.prior(), 10, 1);
  const RowMatrixF x = simulate(task.simulator(), theta, 1, 1);
  CalibrationRanks kept;
  const CalibrationRanks all = rank_truths(amortized(task), theta, x, {.num_samples = 50},
                                           kCalibrationId, [&](const CalibrationRanks& ranks) {
                                             if (ranks.num_done == 6) kept = ranks;
                                           });
  kept.resize(6, 2);
  Index num_calls = 0;
  const CalibrationRanks resumed = rank_truths(amortized(task), theta, x, kept, kCalibrationId,
                                               [&](const CalibrationRanks&) { ++num_calls; });
  EXPECT_EQ(num_calls, 4);
  EXPECT_EQ(resumed.num_done, 10);
  EXPECT_EQ(resumed.parameter, all.parameter);
  EXPECT_EQ(resumed.density, all.density);
  EXPECT_EQ(resumed.distance, all.distance);
  EXPECT_EQ(resumed.theta, all.theta);
  EXPECT_EQ(resumed.log_prob, all.log_prob);
}

}  // namespace
}  // namespace npdr::inference
