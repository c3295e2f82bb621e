#include "sim/noise_likelihood.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/constants.h"
#include "core/error.h"

namespace npdr::sim {
namespace {

constexpr Index kNoisySteps = 40;

ChannelNoise noise_of(bool is_correlated, bool is_heavy_tailed, double deviation) {
  return {.scale = {0.2, deviation},
          .is_correlated = is_correlated,
          .correlation = {0.5, 1.5 * deviation},
          .is_heavy_tailed = is_heavy_tailed,
          .degrees_of_freedom = {1.0 + std::numbers::e, deviation}};
}

NoiseModel model_of(const ChannelNoise& noise, Index rollouts = 2) {
  return NoiseModel({noise}, RowMatrix::Constant(rollouts, 1, 3.0),
                    stored_restarts(kNoisySteps, 10, 1));
}

// Errors of the model itself.
std::vector<float> errors_of(const NoiseModel& model, std::uint64_t seed) {
  std::vector<float> series(
      static_cast<std::size_t>(model.num_rollouts() * model.num_steps() * model.num_states()));
  Stream stream({seed, "observation_noise", 0, 0, 0});
  model.add(series, 1, stream);
  return series;
}

// log p of the errors at known values, one state after the other.
double log_density(const NoiseModel& model, const std::vector<float>& errors, double s, double rho,
                   double nu) {
  double sum = 0.0;
  for (Index h = 0; h < model.num_rollouts(); ++h) {
    double last = 0.0;
    for (Index k = 0; k < model.num_steps(); ++k) {
      const auto i = static_cast<std::size_t>(k);
      if (model.restarts()[i] != 0) last = 0.0;
      const double error =
          static_cast<double>(errors[static_cast<std::size_t>(h * model.num_steps() + k)]) / 3.0;
      const double e = (error - rho * last) / s;
      last = error;
      sum += nu == 0.0 ? -0.5 * e * e - 0.5 * std::log(2.0 * std::numbers::pi) - std::log(s)
                       : std::lgamma(0.5 * (nu + 1.0)) - std::lgamma(0.5 * nu) -
                             0.5 * std::log(nu * std::numbers::pi) - std::log(s) -
                             0.5 * (nu + 1.0) * std::log1p(e * e / nu);
    }
  }
  return sum;
}

// The integral over up to three parameters by the trapezoidal rule on a fine grid.
double log_integral_on_grid(const NoiseModel& model, const std::vector<float>& errors,
                            bool is_correlated, bool is_heavy_tailed) {
  constexpr double step = 0.1, most = 4.5;
  const auto end = [&](bool is_unknown) { return is_unknown ? most : 0.0; };
  double highest = -kInfinity;
  std::vector<double> terms;
  for (double a = -3.0; a <= 3.0; a += step) {
    for (double b = -end(is_correlated); b <= end(is_correlated); b += step) {
      for (double c = -end(is_heavy_tailed); c <= end(is_heavy_tailed); c += 3.0 * step) {
        const double rho = is_correlated ? 1.0 / (1.0 + std::exp(-1.5 * b)) : 0.0;
        const double nu = is_heavy_tailed ? 1.0 + std::exp(1.0 + c) : 0.0;
        terms.push_back(log_density(model, errors, 0.2 * std::exp(a), rho, nu) -
                        0.5 * (a * a + b * b + c * c));
        highest = std::max(highest, terms.back());
      }
    }
  }
  double sum = 0.0;
  for (const double term : terms) sum += std::exp(term - highest);
  const double unknown = 1.0 + (is_correlated ? 1.0 : 0.0) + (is_heavy_tailed ? 1.0 : 0.0);
  const double cell = step * (is_correlated ? step : 1.0) * (is_heavy_tailed ? 3.0 * step : 1.0);
  return highest + std::log(sum * cell) - 0.5 * unknown * std::log(2.0 * std::numbers::pi);
}

// That of the errors, where all simulated states are 0.
double log_likelihood(const NoiseModel& model, const std::vector<float>& errors) {
  return NoiseLikelihood(model, errors).log_likelihood(std::vector<float>(errors.size(), 0.0f));
}

TEST(NoiseLikelihood, OfKnownNoiseIsItsDensity) {
  for (const bool is_heavy_tailed : {false, true}) {
    const NoiseModel model = model_of(noise_of(true, is_heavy_tailed, 0.0));
    const std::vector<float> errors = errors_of(model, 1);
    const double nu = is_heavy_tailed ? 1.0 + std::numbers::e : 0.0;
    EXPECT_NEAR(log_likelihood(model, errors), log_density(model, errors, 0.2, 0.5, nu), 1e-9);
  }
}

// Products of eight squares overflow.
TEST(NoiseLikelihood, OfHugeErrorsIsItsDensity) {
  const NoiseModel model = model_of(noise_of(true, true, 0.0));
  std::vector<float> errors = errors_of(model, 1);
  for (float& error : errors) error *= 1e30f;
  const double wanted = log_density(model, errors, 0.2, 0.5, 1.0 + std::numbers::e);
  EXPECT_NEAR(log_likelihood(model, errors), wanted, 1e-9 * std::abs(wanted));
}

// Tails that heavy don't exist: 1 + e^2 / nu is 1 in double precision.
TEST(NoiseLikelihood, OfManyDegreesOfFreedomIsGaussian) {
  ChannelNoise noise = noise_of(true, true, 0.0);
  noise.degrees_of_freedom.median = 1e18;
  const NoiseModel model = model_of(noise);
  const std::vector<float> errors = errors_of(model, 1);
  EXPECT_NEAR(log_likelihood(model, errors), log_density(model, errors, 0.2, 0.5, 0.0), 1e-4);
}

TEST(NoiseLikelihood, IntegratesUnknownParameters) {
  for (const bool is_correlated : {false, true}) {
    for (const bool is_heavy_tailed : {false, true}) {
      const NoiseModel model = model_of(noise_of(is_correlated, is_heavy_tailed, 1.0));
      const std::vector<float> errors = errors_of(model, 3);
      // Nodes that follow the mode's curvature leave what the integrand isn't a Gaussian.
      EXPECT_NEAR(log_likelihood(model, errors),
                  log_integral_on_grid(model, errors, is_correlated, is_heavy_tailed), 0.02)
          << is_correlated << is_heavy_tailed;
    }
  }
}

TEST(NoiseLikelihood, LeavesARolloutOut) {
  const NoiseModel both = model_of(noise_of(true, true, 1.0)),
                   one = model_of(noise_of(true, true, 1.0), 1);
  const std::vector<float> errors = errors_of(both, 5);
  const std::vector<float> second(errors.begin() + kNoisySteps, errors.end());
  EXPECT_NEAR(NoiseLikelihood(both, errors)
                  .log_likelihood_without(0, std::vector<float>(errors.size(), 0.0f)),
              log_likelihood(one, second), 1e-9);
}

TEST(NoiseLikelihood, IsADensityOfStatesOverTheReferenceAmplitude) {
  ChannelNoise relative = noise_of(false, false, 0.0), in_unit = relative;
  in_unit.is_in_unit = true;
  in_unit.scale.median = 0.2 * 3.0;
  const std::vector<float> errors = errors_of(model_of(relative), 2);
  EXPECT_NEAR(log_likelihood(model_of(relative), errors), log_likelihood(model_of(in_unit), errors),
              1e-9);
}

TEST(NoiseLikelihood, DrawsTheParametersThatMadeTheErrors) {
  // 4000 errors tell scale, correlation and degrees of freedom to some percent; the prior's
  // medians, which the errors were made with, lie within four deviations of the draws.
  ChannelNoise known = noise_of(true, true, 0.0);
  const NoiseModel model({known}, RowMatrix::Constant(100, 1, 3.0),
                         stored_restarts(kNoisySteps, 0, 1));
  const std::vector<float> errors = errors_of(model, 7), none(errors.size(), 0.0f);
  const NoiseLikelihood likelihood(
      NoiseModel({noise_of(true, true, 1.0)}, RowMatrix::Constant(100, 1, 3.0), model.restarts()),
      errors);
  Stream stream({1, "noise_values", 0, 0, 0});
  RowMatrix drawn(400, 3);
  for (Index i = 0; i < drawn.rows(); ++i) {
    const NoiseValues values = likelihood.draw_values(none, stream).front();
    drawn.row(i) << values.scale, values.correlation, values.degrees_of_freedom;
  }
  const Vector mean = drawn.colwise().mean().transpose();
  const Vector truth = (Vector(3) << 0.2, 0.5, 1.0 + std::numbers::e).finished();
  for (Index d = 0; d < 3; ++d) {
    const double deviation = std::sqrt((drawn.col(d).array() - mean(d)).square().mean());
    EXPECT_LT(deviation, 0.15 * truth(d));
    EXPECT_NEAR(mean(d), truth(d), 4.0 * deviation);
  }
}

// Without a floor the scale of the noise would go to 0, and the density beyond all bounds.
TEST(NoiseLikelihood, OfStatesThatAreMetExactlyIsThatOfTheirRounding) {
  constexpr Index steps = 1000;
  const std::vector<float> simulated(steps, 0.0f);
  const std::vector<float> rounded(steps, 3.0f * 0x1p-24f), near(steps, 3e-3f);
  for (const bool is_correlated : {false, true}) {
    for (const bool is_heavy_tailed : {false, true}) {
      const NoiseModel model({noise_of(is_correlated, is_heavy_tailed, 1.0)},
                             RowMatrix::Constant(1, 1, 3.0), stored_restarts(steps, 10, 1));
      const double exact = NoiseLikelihood(model, simulated).log_likelihood(simulated);
      EXPECT_TRUE(std::isfinite(exact));
      EXPECT_GT(exact, NoiseLikelihood(model, near).log_likelihood(simulated));
      if (is_correlated) continue;
      EXPECT_NEAR(exact, NoiseLikelihood(model, rounded).log_likelihood(simulated), 1e-6);
    }
  }
}

TEST(NoiseLikelihood, OfAFailedSimulationIsZero) {
  const NoiseModel model = model_of(noise_of(false, false, 1.0));
  const NoiseLikelihood likelihood(model, errors_of(model, 1));
  const std::vector<float> failed(2 * kNoisySteps, kFloatNaN);
  EXPECT_EQ(likelihood.log_likelihood(failed), -kInfinity);
}

TEST(NoiseLikelihood, RefusesChannelsThatCannotHaveNoise) {
  const std::vector<float> zeros(2 * kNoisySteps);
  ChannelNoise silent = noise_of(false, false, 0.0);
  silent.scale.median = 0.0;
  EXPECT_THROW(NoiseLikelihood(model_of(silent), zeros).require_density(), InputError);
  const NoiseModel still({noise_of(false, false, 1.0)}, RowMatrix::Zero(2, 1),
                         stored_restarts(kNoisySteps, 0, 1));
  EXPECT_THROW(NoiseLikelihood(still, zeros).require_density(), InputError);
  EXPECT_NO_THROW(NoiseLikelihood(model_of(noise_of(false, false, 1.0)), zeros).require_density());
  EXPECT_THROW(NoiseLikelihood(model_of(noise_of(false, false, 1.0)), std::vector<float>(3)),
               ShapeError);
}

TEST(NoiseLikelihood, DrawsParametersOfSilentChannelsFromTheirPriors) {
  ChannelNoise silent = noise_of(true, false, 1.0);
  silent.scale = {};
  const NoiseLikelihood likelihood(model_of(silent), std::vector<float>(2 * kNoisySteps));
  Stream stream(StreamId{1, "draws", 0, 0, 0}), same(StreamId{1, "draws", 0, 0, 0});
  const NoiseValues values =
      likelihood.draw_values(std::vector<float>(2 * kNoisySteps), stream).front();
  const NoiseValues expected = model_of(silent).draw_values(same).front();
  EXPECT_EQ(values.scale, 0.0);
  EXPECT_EQ(values.correlation, expected.correlation);
}

}  // namespace
}  // namespace npdr::sim
