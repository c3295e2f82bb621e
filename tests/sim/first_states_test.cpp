#include "sim/first_states.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/constants.h"
#include "core/error.h"
#include "sim/noise_likelihood.h"

namespace npdr::sim {
namespace {

constexpr Index kRollouts = 2, kSteps = 12, kSegment = 6, kChannels = 2;

// States of x_{k+1} = A x_k, which turns and dies away, after steps 1, ..., kSegment.
RowMatrix motion(const Vector& first) {
  Eigen::Matrix2d step;
  step << 0.95, 0.4, -0.4, 0.9;
  RowMatrix states(kSegment, kChannels);
  Eigen::Vector2d x = first;
  for (Index k = 0; k < kSegment; ++k) states.row(k) = (x = step * x).transpose();
  return states;
}

// Channels of other amplitudes, and segments of both rollouts.
NoiseModel model_of(const std::vector<ChannelNoise>& noise) {
  RowMatrix amplitude(kRollouts, kChannels);
  amplitude << 2.0, 3.0, 1.0, 4.0;
  return {noise, amplitude, stored_restarts(kSteps, kSegment, 1)};
}

ChannelNoise noise_of(double scale, double correlation, double deviation = 0.0) {
  return {.scale = {scale, deviation},
          .is_correlated = correlation > 0.0,
          .correlation = {correlation, 0.0}};
}

NoiseModel usual_model(double correlation) {
  return model_of({noise_of(0.3, correlation), noise_of(0.1, correlation)});
}
std::vector<NoiseValues> usual_values(double correlation) {
  return {{0.3, correlation, 0.0}, {0.1, correlation, 0.0}};
}

// A recording of the motion whose first states are recorded with errors, too, and simulations from
// these first states.
struct Case {
  Target target;
  std::vector<float> recorded, simulated;  // the latter with those of moved first states
  FirstStates first;
};

void add_motion(const Target& target, std::vector<float>& series) {
  for (const Rollout& rollout : target.rollouts) {
    for (Index begin = 0; begin < kSteps; begin += kSegment) {
      const RowMatrix states = motion(rollout.states.row(begin).transpose());
      for (const double value : states.reshaped<Eigen::RowMajor>()) {
        series.push_back(static_cast<float>(value));
      }
    }
  }
}

Case make_case(const NoiseModel& model, std::uint64_t seed) {
  Case made;
  made.first = recorded_first_states(model);
  made.target.state_channels.resize(kChannels);
  Stream stream({seed, "first_states_test", 0, 0, 0});
  for (Index h = 0; h < kRollouts; ++h) {
    RowMatrix states(kSteps + 1, kChannels);
    for (double& value : states.reshaped()) value = 0.5 * stream.normal();
    made.target.rollouts.push_back({"", states, RowMatrix::Zero(kSteps, 0)});
    for (Index k = 1; k <= kSteps; ++k) {
      for (Index c = 0; c < kChannels; ++c) {
        made.recorded.push_back(static_cast<float>(stream.normal()));
      }
    }
  }
  add_motion(begun_at(made.first, model, made.target, kSegment), made.simulated);
  return made;
}

// log N(r; 0, V) of the errors of a segment, over measure(), with V made of what r = eta_k - J
// eta_0 says.
double log_density(const NoiseModel& model, const Case& made, Index h, Index begin,
                   const std::vector<NoiseValues>& values) {
  // Stationary noise of k = 0, ..., kSegment, channel by channel.
  constexpr Index n = kSegment + 1;
  Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(n * kChannels, n * kChannels);
  for (Index c = 0; c < kChannels; ++c) {
    const NoiseValues& at = values[static_cast<std::size_t>(c)];
    const double a = model.unit()(h, c), rho = at.correlation;
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) {
        noise(i * kChannels + c, j * kChannels + c) =
            std::pow(at.scale * a, 2) * std::pow(rho, std::abs(i - j)) / (1.0 - rho * rho);
      }
    }
  }
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(kSegment * kChannels, n * kChannels);
  map.rightCols(kSegment * kChannels).setIdentity();
  for (Index m = 0; m < kChannels; ++m) {
    map.col(m) = -motion(Vector::Unit(kChannels, m)).reshaped<Eigen::RowMajor>();
  }
  const Rollout& rollout = made.target.rollouts[static_cast<std::size_t>(h)];
  const Vector x = motion(rollout.states.row(begin).transpose()).reshaped<Eigen::RowMajor>();
  Vector error(x.size());
  double log_measure = 0.0;
  for (Index i = 0; i < x.size(); ++i) {
    const auto at = static_cast<std::size_t>((h * kSteps + begin) * kChannels + i);
    error(i) = static_cast<double>(made.recorded[at]) - x(i);
    log_measure += std::log(model.measure()(h, i % kChannels));
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(map * noise * map.transpose());
  return log_measure - 0.5 * factor.matrixL().solve(error).squaredNorm() -
         factor.matrixLLT().diagonal().array().log().sum() -
         0.5 * static_cast<double>(x.size()) * std::log(2.0 * std::numbers::pi);
}

double log_density(const NoiseModel& model, const Case& made,
                   const std::vector<NoiseValues>& values) {
  double sum = 0.0;
  for (Index h = 0; h < kRollouts; ++h) {
    for (Index begin = 0; begin < kSteps; begin += kSegment) {
      sum += log_density(model, made, h, begin, values);
    }
  }
  return sum;
}

TEST(FirstStates, OfALinearMotionLeaveAGaussianDensity) {
  for (const double correlation : {0.0, 0.7}) {
    const NoiseModel model = usual_model(correlation);
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const Case made = make_case(model, seed);
      const NoiseLikelihood likelihood(model, made.recorded, made.first);
      const double expected = log_density(model, made, usual_values(correlation));
      EXPECT_NEAR(likelihood.log_likelihood(made.simulated), expected, 1e-3 * std::abs(expected));
    }
  }
}

// The integral over both scales by the trapezoidal rule. Errors of 24 states a channel leave the
// quadrature 0.01 nats.
TEST(FirstStates, IntegrateUnknownScalesOfAllChannels) {
  const NoiseModel model = model_of({noise_of(0.3, 0.0, 1.0), noise_of(0.3, 0.0, 1.0)});
  const Case made = make_case(model, 4);
  constexpr double step = 0.05;
  double sum = 0.0, highest = -kInfinity;
  std::vector<double> terms;
  for (double a = -4.0; a <= 4.0; a += step) {
    for (double b = -4.0; b <= 4.0; b += step) {
      terms.push_back(log_density(model, made, {{0.3 * std::exp(a)}, {0.3 * std::exp(b)}}) -
                      0.5 * (a * a + b * b) + std::log(step * step / (2.0 * std::numbers::pi)));
      highest = std::max(highest, terms.back());
    }
  }
  for (const double term : terms) sum += std::exp(term - highest);
  const NoiseLikelihood likelihood(model, made.recorded, made.first);
  EXPECT_NEAR(likelihood.log_likelihood(made.simulated), highest + std::log(sum), 0.01);
}

TEST(FirstStates, AreLeftOutWithTheirRollout) {
  const NoiseModel model = usual_model(0.0);
  const Case made = make_case(model, 5);
  const std::vector<NoiseValues> values = {{0.3}, {0.1}};
  const NoiseLikelihood likelihood(model, made.recorded, made.first);
  const double expected =
      log_density(model, made, 0, 0, values) + log_density(model, made, 0, kSegment, values);
  EXPECT_NEAR(likelihood.log_likelihood_without(1, made.simulated), expected,
              1e-3 * std::abs(expected));
}

// A recording that is the motion from other first states is met by them.
TEST(FirstStates, AreFoundWhereNoiseIsSmall) {
  const NoiseModel model = model_of({noise_of(1e-4, 0.0), noise_of(1e-4, 0.0)});
  Case made = make_case(model, 6);
  Target truth = made.target;
  for (Rollout& rollout : truth.rollouts) rollout.states.array() += 1e-3;
  made.recorded.clear();
  add_motion(truth, made.recorded);
  const FirstStateErrors errors(model, made.recorded, made.simulated, made.first);
  const RowMatrix found = errors.first_errors({{1e-4}, {1e-4}});
  ASSERT_EQ(found.rows(), 4);
  const std::vector<float> corrected = from_first_states(model, made.simulated, made.first, found);
  for (std::size_t i = 0; i < corrected.size(); ++i) {
    EXPECT_NEAR(corrected[i], made.recorded[i], 3e-4) << "of 1e-3, less what the prior holds back";
  }
}

// To first order all is the same wherever simulations begin, and a linear motion is its first
// order.
TEST(FirstStates, OfALinearMotionMayBeginAnywhere) {
  for (const double correlation : {0.0, 0.7}) {
    const NoiseModel model = usual_model(correlation);
    const std::vector<NoiseValues> values = usual_values(correlation);
    Case made = make_case(model, 9);
    const FirstStateErrors recorded(model, made.recorded, made.simulated, made.first);
    const double expected = log_density(model, made, values);
    const RowMatrix found = recorded.first_errors(values);
    made.first.errors << 0.2, -0.1, 0.0, 0.3, -0.2, 0.1, 0.4, 0.0;
    made.simulated.clear();
    add_motion(begun_at(made.first, model, made.target, kSegment), made.simulated);
    const FirstStateErrors errors(model, made.recorded, made.simulated, made.first);
    EXPECT_NEAR(errors.log_density(values), expected, 1e-3 * std::abs(expected));
    EXPECT_TRUE(errors.first_errors(values).isApprox(found, 1e-3));
    const NoiseLikelihood likelihood(model, made.recorded, made.first);
    const NoiseLikelihood::FirstStateFit fit = likelihood.fit_first_states(made.simulated);
    EXPECT_TRUE(fit.errors.isApprox(found, 1e-3));
    std::vector<float> from_there;
    made.first.errors = fit.errors;
    add_motion(begun_at(made.first, model, made.target, kSegment), from_there);
    from_there.resize(fit.states.size());
    EXPECT_LT(likelihood.distance(fit.states, from_there, values), 0.01);
  }
}

// Of a linear motion the misfit is a parabola: the likeliest first states make it smallest.
TEST(FirstStates, ThatAreLikeliestFitBest) {
  for (const double correlation : {0.0, 0.7}) {
    const NoiseModel model = usual_model(correlation);
    const std::vector<NoiseValues> values = usual_values(correlation);
    Case made = make_case(model, 10);
    const RowMatrix likeliest =
        FirstStateErrors(model, made.recorded, made.simulated, made.first).first_errors(values);
    const auto misfit_at = [&](const RowMatrix& errors) {
      made.first.errors = errors;
      std::vector<float> simulated;
      add_motion(begun_at(made.first, model, made.target, kSegment), simulated);
      return NoiseLikelihood(model, made.recorded, made.first).misfit(simulated, values);
    };
    const double least = misfit_at(likeliest);
    for (Index s = 0; s < likeliest.rows(); ++s) {
      for (Index c = 0; c < kChannels; ++c) {
        RowMatrix more = likeliest, less = likeliest;
        more(s, c) += 0.1;
        less(s, c) -= 0.1;
        const double above = misfit_at(more) - least, below = misfit_at(less) - least;
        EXPECT_GT(above, 0.0);
        EXPECT_NEAR(below, above, 1e-2 * above);
      }
    }
  }
}

TEST(FirstStates, OfAFailedSimulationHaveNoLikelihood) {
  const NoiseModel model = usual_model(0.0);
  Case made = make_case(model, 7);
  made.simulated.back() = kFloatNaN;
  const NoiseLikelihood likelihood(model, made.recorded, made.first);
  EXPECT_EQ(likelihood.log_likelihood(made.simulated), -kInfinity);
}

TEST(FirstStates, RefuseOtherShapesAndHeavyTails) {
  const NoiseModel model = usual_model(0.0);
  const Case made = make_case(model, 8);
  const NoiseLikelihood likelihood(model, made.recorded, made.first);
  EXPECT_NO_THROW(likelihood.require_density());
  EXPECT_THROW((void)likelihood.log_likelihood(made.recorded), ShapeError);
  ChannelNoise heavy = noise_of(0.1, 0.0);
  heavy.is_heavy_tailed = true;
  heavy.degrees_of_freedom = {4.0, 0.0};
  const NoiseModel tails = model_of({heavy, heavy});
  EXPECT_THROW(NoiseLikelihood(tails, made.recorded, made.first).require_density(), InputError);
}

}  // namespace
}  // namespace npdr::sim
