#include "sim/noise_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/normal.h"
#include "sim/observation_noise.h"

namespace npdr::sim {
namespace {

Stream stream_of(std::uint64_t seed) { return Stream({seed, "observation_noise", 0, 0, 0}); }

std::vector<float> draw(const NoiseModel& model, Index stride = 1) {
  std::vector<float> series(static_cast<std::size_t>(
      model.num_rollouts() * (model.num_steps() / stride) * model.num_states()));
  Stream stream = stream_of(3);
  model.add(series, stride, stream);
  return series;
}

TEST(NoiseModel, RestartsWhereASegmentBegins) {
  // Segments of 4 steps, every third state of 12 is stored: those after steps 3, 6, 9 and 12.
  EXPECT_EQ(stored_restarts(12, 4, 3), (std::vector<char>{1, 1, 1, 0}));
  EXPECT_EQ(stored_restarts(6, 0, 1), (std::vector<char>{1, 0, 0, 0, 0, 0}));
}

TEST(NoiseModel, WhiteNoiseIsThatOfObservationNoise) {
  const RowMatrix amplitude = RowMatrix::Constant(2, 1, 5.0);
  const NoiseModel model({{.scale = {0.1, 0.0}}}, amplitude, stored_restarts(50, 10, 1));
  std::vector<float> expected(100);
  Stream stream = stream_of(3);
  add_observation_noise(expected, 0.1 * amplitude, stream);
  EXPECT_EQ(draw(model), expected);
}

// Noise of one channel: s = 0.5 in units of amplitude 2.
NoiseModel dependent(double rho, double nu, Index steps, Index segment_length) {
  return NoiseModel({{.scale = {0.5, 0.0},
                      .is_correlated = rho > 0.0,
                      .correlation = {rho, 0.0},
                      .is_heavy_tailed = nu > 0.0,
                      .degrees_of_freedom = {nu, 0.0}}},
                    RowMatrix::Constant(1, 1, 2.0), stored_restarts(steps, segment_length, 1));
}

TEST(NoiseModel, CorrelatedNoiseHasItsVarianceAndCorrelation) {
  constexpr Index steps = 100'000;
  const std::vector<float> error = draw(dependent(0.8, 0.0, steps, 0));
  double squares = 0.0, products = 0.0;
  for (std::size_t k = 1; k < error.size(); ++k) {
    squares += std::pow(error[k], 2);
    products += static_cast<double>(error[k]) * static_cast<double>(error[k - 1]);
  }
  // The estimated correlation has standard error sqrt((1 - rho^2) / n) = 0.002, the variance a
  // relative one of sqrt(2 (1 + rho^2) / (1 - rho^2) / n) = 0.01; five of each.
  EXPECT_NEAR(products / squares, 0.8, 0.01);
  EXPECT_NEAR(squares / steps, 1.0 / (1.0 - 0.64), 0.05 / (1.0 - 0.64));
}

TEST(NoiseModel, SizeIsTheRootMeanSquareOfTheNoise) {
  EXPECT_DOUBLE_EQ(dependent(0.0, 0.0, 12, 4).relative_size()(0, 0), 0.5);
  const double variances = (1.0 + 1.81 + (1.81 * 0.81 + 1.0) + ((1.81 * 0.81 + 1.0) * 0.81 + 1.0));
  EXPECT_NEAR(dependent(0.9, 0.0, 12, 4).relative_size()(0, 0), 0.5 * std::sqrt(variances / 4.0),
              1e-12);
  EXPECT_NEAR(dependent(0.0, 6.0, 12, 4).relative_size()(0, 0), 0.5 * std::sqrt(1.5), 1e-12);
  const NoiseModel in_unit({{.scale = {0.3, 0.0}, .is_in_unit = true}, {}},
                           RowMatrix{{2.0, 5.0}, {0.0, 5.0}}, stored_restarts(12, 4, 1));
  EXPECT_TRUE(in_unit.relative_size().isApprox(RowMatrix{{0.15, 0.0}, {0.3, 0.0}}));
}

TEST(NoiseModel, CorrelatedNoiseStartsAnewInEachSegment) {
  constexpr Index steps = 40'000;
  const std::vector<float> error = draw(dependent(0.9, 0.0, steps, 4));
  double first = 0.0, last = 0.0;
  for (std::size_t k = 0; k < error.size(); k += 4) {
    first += std::pow(error[k], 2);
    last += std::pow(error[k + 3], 2);
  }
  // Variances 1 and 1 + 0.81 + 0.81^2 + 0.81^3 of 10,000 values: five standard errors of 1.4 %.
  EXPECT_NEAR(first / 10'000, 1.0, 0.07);
  EXPECT_NEAR(last / 10'000, 2.9975, 0.07 * 2.9975);
}

TEST(NoiseModel, HeavyTailsAreStudents) {
  constexpr Index steps = 100'000;
  const std::vector<float> error = draw(dependent(0.0, 3.0, steps, 0));
  // Quartile and 99 % quantile of |t| with 3 degrees of freedom: 0.7649 and 5.8409. Shares have
  // standard errors 0.0016 and 0.0003; five of each.
  double half = 0.0, far = 0.0;
  for (const float e : error) {
    half += std::abs(e) < 0.7649f ? 1.0 : 0.0;
    far += std::abs(e) > 5.8409f ? 1.0 : 0.0;
  }
  EXPECT_NEAR(half / steps, 0.5, 0.008);
  EXPECT_NEAR(far / steps, 0.01, 0.0016);
}

TEST(NoiseModel, EveryOtherStateHasTheNoiseOfThatState) {
  const NoiseModel model = dependent(0.7, 4.0, 20, 5);
  const std::vector<float> all = draw(model), some = draw(model, 2);
  ASSERT_EQ(some.size(), 10u);
  for (std::size_t k = 0; k < some.size(); ++k) EXPECT_EQ(some[k], all[2 * k + 1]);
}

TEST(NoiseModel, DrawsUnknownParametersFromTheirPriors) {
  const NoiseModel model({{.scale = {0.2, 1.0},
                           .is_correlated = true,
                           .correlation = {0.5, 1.5},
                           .is_heavy_tailed = true,
                           .degrees_of_freedom = {3.0, 1.0}}},
                         RowMatrix::Ones(1, 1), {1});
  Stream stream = stream_of(1);
  double scale = 0.0, correlation = 0.0, degrees = 0.0;
  constexpr int n = 20'000;
  for (int i = 0; i < n; ++i) {
    const NoiseValues values = model.draw_values(stream).front();
    scale += values.scale < 0.2 ? 1.0 : 0.0;
    correlation += values.correlation < 1.0 / (1.0 + std::exp(1.5)) ? 1.0 : 0.0;
    degrees += values.degrees_of_freedom < 1.0 + 2.0 * std::exp(1.0) ? 1.0 : 0.0;
  }
  // Shares below the median and a deviation below and above it: five standard errors of 0.0035.
  EXPECT_NEAR(scale / n, 0.5, 0.018);
  EXPECT_NEAR(correlation / n, 0.1587, 0.018);
  EXPECT_NEAR(degrees / n, 0.8413, 0.018);
}

// The deviation of the noise that is added, at each state since a restart; s = 0.3, a = 2.
TEST(NoiseModel, MarginalDensityIsThatOfTheNoiseThatIsAdded) {
  constexpr Index steps = 6;
  const NoiseModel model({{.scale = {0.3, 0.0}, .is_correlated = true, .correlation = {0.8, 0.0}}},
                         RowMatrix::Constant(1, 1, 2.0), stored_restarts(steps, 4, 1));
  Stream stream = stream_of(3);
  const NoiseValues values = model.draw_values(stream).front();
  Vector squares = Vector::Zero(steps);
  constexpr int n = 20'000;
  for (int i = 0; i < n; ++i) {
    std::vector<float> error(steps);
    model.add(error, 1, stream);
    for (Index k = 0; k < steps; ++k) squares(k) += std::pow(error[static_cast<std::size_t>(k)], 2);
  }
  for (Index k = 0; k < steps; ++k) {
    const double deviation = std::sqrt(squares(k) / n);
    // log N(0; 0, d^2) + log a. A variance of n draws is known to 1 %; five such errors.
    EXPECT_NEAR(model.log_marginal(0, k, 0, 0.0, values),
                log_normal_density(0.0) - std::log(deviation / 2.0), 0.025)
        << k;
    EXPECT_NEAR(
        model.log_marginal(0, k, 0, deviation, values) - model.log_marginal(0, k, 0, 0.0, values),
        -0.5, 0.05);
  }
}

TEST(NoiseModel, MarginalDensityOfHeavyTailsIsStudents) {
  const NoiseModel model(
      {{.scale = {0.5, 0.0}, .is_heavy_tailed = true, .degrees_of_freedom = {2.0, 0.0}}},
      RowMatrix::Constant(1, 1, 4.0), {1, 0});
  Stream stream = stream_of(1);
  const NoiseValues values = model.draw_values(stream).front();
  EXPECT_NEAR(model.log_marginal(0, 1, 0, 6.0, values),
              log_student_t_density(3.0, 2.0) - std::log(0.5), 1e-12);
}

TEST(NoiseModel, RefusesValuesOutOfRange) {
  const auto make = [](ChannelNoise noise) {
    return NoiseModel({noise}, RowMatrix::Ones(1, 1), {1});
  };
  EXPECT_THROW(make({.scale = {-1.0, 0.0}}), InputError);
  EXPECT_THROW(make({.scale = {0.0, 1.0}}), InputError);
  EXPECT_THROW(make({.scale = {1.0, 0.0}, .is_correlated = true, .correlation = {1.0, 0.0}}),
               InputError);
  EXPECT_THROW(
      make({.scale = {1.0, 0.0}, .is_heavy_tailed = true, .degrees_of_freedom = {1.0, 0.0}}),
      InputError);
  EXPECT_THROW(NoiseModel({}, RowMatrix::Ones(1, 1), {1}), ShapeError);
}

}  // namespace
}  // namespace npdr::sim
