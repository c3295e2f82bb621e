#include "sim/noise_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/error.h"
#include "core/normal.h"
#include "sim/noise_transform.h"
#include "sim/observation_noise.h"

namespace npdr::sim {
namespace {

void check(const ChannelNoise& noise) {
  const auto refuse = [](const char* name, double value, const char* allowed) {
    throw InputError(std::string("noise: ") + name + " " + std::to_string(value) + ", must be " +
                     allowed);
  };
  const double scale = noise.scale.median;
  const bool is_positive = std::isfinite(scale) && scale > 0.0;
  if (!is_positive && (noise.scale.is_unknown() || scale != 0.0)) {
    refuse("scale", scale, noise.scale.is_unknown() ? "> 0" : ">= 0");
  }
  const double rho = noise.correlation.median;
  const bool is_inside = rho < 1.0 && (noise.correlation.is_unknown() ? rho > 0.0 : rho >= 0.0);
  if (noise.is_correlated && !is_inside) refuse("correlation", rho, "in [0, 1)");
  const double nu = noise.degrees_of_freedom.median;
  if (noise.is_heavy_tailed && !(nu > 1.0)) refuse("degrees of freedom", nu, "> 1");
}

// Student's t with any degrees of freedom (Bailey 1994, "Polar generation of random variates with
// the t-distribution").
double student_t(double degrees_of_freedom, Stream& stream) {
  const double radius =
      degrees_of_freedom * std::expm1(-2.0 / degrees_of_freedom * std::log(stream.uniform()));
  return std::sqrt(radius) * std::cos(2.0 * std::numbers::pi * stream.uniform());
}

}  // namespace

std::vector<char> stored_restarts(Index num_steps, Index segment_length, Index store_every) {
  std::vector<char> restarts(static_cast<std::size_t>(num_steps / store_every));
  Index last = -1;
  for (std::size_t k = 0; k < restarts.size(); ++k) {
    const Index step = (static_cast<Index>(k) + 1) * store_every;
    const Index segment = segment_length == 0 ? 0 : (step - 1) / segment_length;
    restarts[k] = segment != last;
    last = segment;
  }
  return restarts;
}

NoiseModel::NoiseModel(std::vector<ChannelNoise> channels, RowMatrix amplitude,
                       std::vector<char> restarts)
    : channels_(std::move(channels)), unit_(std::move(amplitude)), restarts_(std::move(restarts)) {
  if (std::ssize(channels_) != unit_.cols()) {
    throw ShapeError("noise of " + std::to_string(channels_.size()) + " channels, amplitudes of " +
                     std::to_string(unit_.cols()));
  }
  for (const ChannelNoise& noise : channels_) check(noise);
  measure_ = (unit_.array() > 0.0).select(unit_, 1.0);
  for (Index c = 0; c < unit_.cols(); ++c) {
    if (channels_[static_cast<std::size_t>(c)].is_in_unit) unit_.col(c).setOnes();
  }
  for (const char is_restart : restarts_) {
    age_.push_back(is_restart != 0 || age_.empty() ? 1 : age_.back() + 1);
  }
}

bool NoiseModel::is_silent() const {
  return std::ranges::all_of(channels_,
                             [](const ChannelNoise& noise) { return noise.scale.median == 0.0; });
}

bool NoiseModel::has_density(Index channel) const {
  return channels_[static_cast<std::size_t>(channel)].scale.median > 0.0 &&
         unit_.col(channel).minCoeff() > 0.0;
}

double NoiseModel::growth(Index k, double correlation) const {
  const double rho2 = correlation * correlation;
  const auto age = static_cast<double>(age_[static_cast<std::size_t>(k)]);
  return (1.0 - std::pow(rho2, age)) / (1.0 - rho2);
}

NoiseModel NoiseModel::with_unknown_scales() const {
  NoiseModel result = *this;
  for (ChannelNoise& channel : result.channels_) {
    if (!channel.scale.is_unknown() && channel.scale.median > 0.0) channel.scale.deviation = 1.0;
  }
  return result;
}

RowMatrix NoiseModel::relative_size() const {
  RowMatrix size = unit_.cwiseQuotient(measure_);
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    const ChannelNoise& noise = channels_[c];
    double variance = 0.0;
    for (Index k = 0; k < num_steps(); ++k) variance += growth(k, noise.correlation.median);
    variance /= static_cast<double>(num_steps());
    const double nu = noise.degrees_of_freedom.median;
    if (noise.is_heavy_tailed && nu > 2.0) variance *= nu / (nu - 2.0);
    size.col(static_cast<Index>(c)) *= noise.scale.median * std::sqrt(variance);
  }
  return size;
}

double NoiseModel::log_marginal(Index h, Index k, Index c, double error,
                                const NoiseValues& values) const {
  const double variance = growth(k, values.correlation);
  const double deviation = values.scale * unit_(h, c) * std::sqrt(variance);
  const double log_unit = std::log(deviation / measure_(h, c));
  const double e = error / deviation;
  if (!channels_[static_cast<std::size_t>(c)].is_heavy_tailed) {
    return log_normal_density(e) - log_unit;
  }
  return log_student_t_density(e, values.degrees_of_freedom) - log_unit;
}

bool NoiseModel::has_unknown() const {
  return std::ranges::any_of(
      channels_, [](const ChannelNoise& noise) { return NoiseTransform(noise).dimension() > 0; });
}

std::vector<NoiseValues> NoiseModel::with_unknown_scales_times(
    double factor, std::vector<NoiseValues> values) const {
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    if (channels_[c].scale.is_unknown()) values[c].scale *= factor;
  }
  return values;
}

std::vector<NoiseValues> NoiseModel::draw_values(Stream& stream) const {
  std::vector<NoiseValues> values;
  for (const ChannelNoise& noise : channels_) {
    Vector z(NoiseTransform(noise).dimension());
    for (double& normal : z) normal = stream.normal();
    values.push_back(NoiseTransform(noise).values(z));
  }
  return values;
}

void NoiseModel::add(std::span<float> series, Index stride, Stream& stream) const {
  const bool is_white = std::ranges::none_of(channels_, [](const ChannelNoise& noise) {
    return noise.is_correlated || noise.is_heavy_tailed;
  });
  const std::vector<NoiseValues> values = draw_values(stream);
  if (!is_white) return add_dependent(series, stride, values, stream);
  RowMatrix deviation = unit_;
  for (std::size_t c = 0; c < values.size(); ++c) {
    deviation.col(static_cast<Index>(c)) *= values[c].scale;
  }
  add_observation_noise(series, deviation, stream);
}

void NoiseModel::add(std::span<float> series, const std::vector<NoiseValues>& values,
                     Stream& stream) const {
  add_dependent(series, 1, values, stream);
}

void NoiseModel::add_dependent(std::span<float> series, Index stride,
                               const std::vector<NoiseValues>& values, Stream& stream) const {
  const Index picked = num_steps() / stride;
  if (std::ssize(series) != num_rollouts() * picked * num_states()) {
    throw ShapeError("noise for series of " +
                     std::to_string(num_rollouts() * picked * num_states()) + " values, not " +
                     std::to_string(series.size()));
  }
  float* value = series.data();
  Vector error(num_states());
  for (Index h = 0; h < num_rollouts(); ++h) {
    for (Index k = 0; k < picked * stride; ++k) {
      if (restarts_[static_cast<std::size_t>(k)] != 0) error.setZero();
      for (Index c = 0; c < num_states(); ++c) {
        const auto i = static_cast<std::size_t>(c);
        const double e = channels_[i].is_heavy_tailed
                             ? student_t(values[i].degrees_of_freedom, stream)
                             : stream.normal();
        error(c) = values[i].correlation * error(c) + values[i].scale * unit_(h, c) * e;
      }
      if ((k + 1) % stride != 0) continue;
      for (Index c = 0; c < num_states(); ++c) *value++ += static_cast<float>(error(c));
    }
  }
}

}  // namespace npdr::sim
