#include "sim/channel_errors.h"

#include <cmath>

#include "core/constants.h"
#include "core/normal.h"

namespace npdr::sim {
namespace {

// Degrees of freedom beyond which Student's t is taken for one with these: as good as Gaussian,
// while 1 + e^2 / nu still tells e.
constexpr double kMostDegrees = 1e7;

// Sum of log(1 + (now - rho before)^2 / spread): of products of eight, unless one overflows.
double log_of_squares(const ChannelErrors& errors, double rho, double spread) {
  const auto factors_of = [&](Index first, Index count) {
    const auto now = errors.now.segment(first, count), before = errors.before.segment(first, count);
    return 1.0 + (now - rho * before).square().max(errors.rounding) * (1.0 / spread);
  };
  constexpr Index factors = 8;
  const Index n = errors.now.size() / factors, rest = factors * n;
  Eigen::ArrayXd product = factors_of(0, n);
  for (Index k = 1; k < factors; ++k) product *= factors_of(k * n, n);
  const double sum = product.log().sum() + factors_of(rest, errors.now.size() - rest).log().sum();
  return std::isfinite(sum) ? sum : factors_of(0, errors.now.size()).log().sum();
}

double log_density(const ChannelNoise& noise, const ChannelErrors& errors, const NoiseValues& at) {
  const auto n = static_cast<double>(errors.now.size());
  const double rho = at.correlation;
  if (!noise.is_heavy_tailed) {
    return -n * (std::log(at.scale) + 0.5 * kLogTwoPi) -
           0.5 * errors.squares(rho) / (at.scale * at.scale);
  }
  const double nu = std::min(at.degrees_of_freedom, kMostDegrees);
  const double sum = log_of_squares(errors, rho, nu * at.scale * at.scale);
  return n * (log_student_t_density(0.0, nu) - std::log(at.scale)) - 0.5 * (nu + 1.0) * sum;
}

}  // namespace

Eigen::ArrayXd scores(const ChannelNoise& noise, const NoiseValues& values,
                      const Eigen::ArrayXd& independent) {
  if (!noise.is_heavy_tailed) return independent;
  const double nu = std::min(values.degrees_of_freedom, kMostDegrees);
  const double information = (nu + 1.0) / (nu + 3.0);
  return (nu + 1.0) * independent / (nu + independent.square()) / std::sqrt(information);
}

double ChannelIntegrand::operator()(const Vector& z) const {
  const double value = log_density(noise_, errors_, transform_.values(z)) - 0.5 * z.squaredNorm() -
                       0.5 * static_cast<double>(z.size()) * kLogTwoPi;
  return std::isnan(value) ? -kInfinity : value;
}

Vector guess_of(const ChannelNoise& noise, double size, double correlation) {
  Vector z = Vector::Zero(NoiseTransform(noise).dimension());
  Index next = 0;
  if (noise.scale.is_unknown()) {
    const double tails = noise.is_heavy_tailed ? 0.7 : 1.0;
    z(next++) = std::log(tails * size / noise.scale.median) / noise.scale.deviation;
  }
  if (noise.is_correlated && noise.correlation.is_unknown()) {
    const double median = noise.correlation.median;
    z(next++) = std::log(correlation / (1.0 - correlation) * (1.0 - median) / median) /
                noise.correlation.deviation;
  }
  return z;
}

Vector ChannelIntegrand::guess() const {
  const double ratio = errors_.before_squared > 0.0
                           ? std::clamp(errors_.product / errors_.before_squared, 0.02, 0.98)
                           : 0.5;
  const double mean =
      errors_.squares(noise_.is_correlated ? ratio : 0.0) / static_cast<double>(errors_.now.size());
  return guess_of(noise_, std::sqrt(mean), ratio);
}

ChannelErrors channel_errors(const NoiseModel& model, std::span<const float> recorded,
                             std::span<const float> simulated, Index c, Index left_out) {
  const Index steps = model.num_steps(), states = model.num_states();
  const Index rollouts = model.num_rollouts() - (left_out >= 0 ? 1 : 0);
  ChannelErrors errors{Eigen::ArrayXd(rollouts * steps), Eigen::ArrayXd(rollouts * steps)};
  // A scale in the channel's unit is given.
  const bool is_in_unit = model.channels()[static_cast<std::size_t>(c)].is_in_unit;
  errors.rounding = is_in_unit ? 0.0 : kStateRounding * kStateRounding;
  Index next = 0;
  for (Index h = 0; h < model.num_rollouts(); ++h) {
    if (h == left_out) continue;
    const double unit = model.unit()(h, c);
    errors.log_measure += static_cast<double>(steps) * std::log(model.measure()(h, c) / unit);
    double last = 0.0;
    for (Index k = 0; k < steps; ++k, ++next) {
      const auto i = static_cast<std::size_t>((h * steps + k) * states + c);
      const double error =
          (static_cast<double>(recorded[i]) - static_cast<double>(simulated[i])) / unit;
      errors.now(next) = error;
      errors.before(next) = model.restarts()[static_cast<std::size_t>(k)] != 0 ? 0.0 : last;
      last = error;
    }
  }
  errors.now_squared = errors.now.square().sum();
  errors.product = (errors.now * errors.before).sum();
  errors.before_squared = errors.before.square().sum();
  return errors;
}

}  // namespace npdr::sim
