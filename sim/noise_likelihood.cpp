#include "sim/noise_likelihood.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/constants.h"
#include "core/error.h"
#include "sim/channel_errors.h"
#include "sim/noise_integral.h"

namespace npdr::sim {
namespace {

// log of density times prior over the unknown parameters of all channels, one after the other,
// which depend on each other where first states aren't known.
class JointIntegrand {
 public:
  JointIntegrand(const NoiseModel& model, const FirstStateErrors& errors)
      : model_(model), errors_(errors) {}

  std::vector<NoiseValues> values(const Vector& z) const {
    std::vector<NoiseValues> values;
    Index next = 0;
    for (const ChannelNoise& noise : model_.channels()) {
      const NoiseTransform transform(noise);
      values.push_back(transform.values(z.segment(next, transform.dimension())));
      next += transform.dimension();
    }
    return values;
  }

  double operator()(const Vector& z) const {
    const double value = errors_.log_density(values(z)) - 0.5 * z.squaredNorm() -
                         0.5 * static_cast<double>(z.size()) * kLogTwoPi;
    return std::isnan(value) ? -kInfinity : value;
  }

  Vector guess() const {
    const Vector size = errors_.size(), correlation = errors_.correlation();
    Vector z;
    for (Index c = 0; c < model_.num_states(); ++c) {
      const ChannelNoise& noise = model_.channels()[static_cast<std::size_t>(c)];
      const double rho = noise.is_correlated ? std::clamp(correlation(c), 0.02, 0.98) : 0.0;
      const Vector its = guess_of(noise, size(c) * std::sqrt(1.0 - rho * rho), rho);
      z.conservativeResize(z.size() + its.size());
      z.tail(its.size()) = its;
    }
    return z;
  }

 private:
  const NoiseModel& model_;
  const FirstStateErrors& errors_;
};

// Whether a state is the first of its segment, of all rollouts (H K).
std::vector<char> restarts_of_rollouts(const NoiseModel& model) {
  std::vector<char> restarts;
  for (Index h = 0; h < model.num_rollouts(); ++h) {
    restarts.insert(restarts.end(), model.restarts().begin(), model.restarts().end());
  }
  return restarts;
}

// Puts the errors of first states (S) before those of the states that they restart.
void begin_with(const Eigen::Ref<const Vector>& first_errors, const std::vector<char>& restarts,
                ChannelErrors& errors) {
  Index segment = 0;
  for (Index k = 0; k < errors.before.size(); ++k) {
    if (restarts[static_cast<std::size_t>(k)] != 0) errors.before(k) = first_errors(segment++);
  }
}

// e of N(0, 1), where errors are Gaussian noise at these values.
Eigen::ArrayXd independent(const ChannelErrors& errors, const NoiseValues& at) {
  return (errors.now - at.correlation * errors.before) / at.scale;
}

Vector mode_of(const LogIntegrand& f, const Vector& guess) {
  return guess.size() == 0 ? guess : find_peak(f, guess).mode;
}

}  // namespace

NoiseLikelihood::NoiseLikelihood(NoiseModel model, std::vector<float> recorded,
                                 std::optional<FirstStates> first_states)
    : model_(std::move(model)),
      recorded_(std::move(recorded)),
      first_states_(std::move(first_states)) {
  if (std::ssize(recorded_) != model_.num_rollouts() * model_.num_steps() * model_.num_states()) {
    throw ShapeError("likelihood: " + std::to_string(recorded_.size()) +
                     " recorded values are not those of the noise's rollouts, steps and channels");
  }
}

void NoiseLikelihood::require_density() const {
  for (Index c = 0; c < model_.num_states(); ++c) {
    if (model_.channels()[static_cast<std::size_t>(c)].scale.median == 0.0) {
      throw InputError("likelihood: the noise of channel " + std::to_string(c + 1) +
                       " has scale 0, must be > 0");
    }
    if (!model_.has_density(c)) {
      throw InputError("likelihood: channel " + std::to_string(c + 1) +
                       " is 0 throughout a rollout, so noise relative to it is none; give its "
                       "scale in its unit");
    }
    if (infers_first_states() && model_.channels()[static_cast<std::size_t>(c)].is_heavy_tailed) {
      throw InputError(
          "likelihood: first states are inferred of noise without heavy tails alone; leave its "
          "degrees_of_freedom out");
    }
  }
}

double NoiseLikelihood::log_likelihood(std::span<const float> simulated) const {
  return log_likelihood_without(-1, simulated);
}

double NoiseLikelihood::log_likelihood_without(Index left_out,
                                               std::span<const float> simulated) const {
  const double value = infers_first_states() ? joint_log_likelihood(left_out, simulated)
                                             : sum_of_channels(left_out, simulated);
  return std::isnan(value) ? -kInfinity : value;
}

double NoiseLikelihood::sum_of_channels(Index left_out, std::span<const float> simulated) const {
  double sum = 0.0;
  for (Index c = 0; c < model_.num_states(); ++c) {
    const ChannelErrors errors = channel_errors(model_, recorded_, simulated, c, left_out);
    if (!std::isfinite(errors.now_squared)) return -kInfinity;
    const ChannelIntegrand f(model_.channels()[static_cast<std::size_t>(c)], errors);
    sum += log_integral(f, f.guess()) + errors.log_measure;
  }
  return sum;
}

double NoiseLikelihood::joint_log_likelihood(Index left_out,
                                             std::span<const float> simulated) const {
  const FirstStateErrors errors(model_, recorded_, simulated, *first_states_, left_out);
  if (!errors.are_finite()) return -kInfinity;
  const JointIntegrand f(model_, errors);
  return log_integral(f, f.guess());
}

std::vector<NoiseValues> NoiseLikelihood::draw_values(std::span<const float> simulated,
                                                      Stream& stream, Index left_out) const {
  std::optional<NoiseModel> of_predictions;
  if (infers_first_states()) of_predictions = model_.with_unknown_scales();
  const NoiseModel& model = of_predictions ? *of_predictions : model_;
  std::vector<NoiseValues> values;
  for (Index c = 0; c < model_.num_states(); ++c) {
    const ChannelErrors errors = channel_errors(model, recorded_, simulated, c, left_out);
    const ChannelIntegrand f(model.channels()[static_cast<std::size_t>(c)], errors);
    Vector z(f.dimension());
    for (double& normal : z) normal = stream.normal();
    if (z.size() > 0 && model_.has_density(c)) {
      const Peak peak = find_peak(f, f.guess());
      z = peak.mode + peak.factor * z;
    }
    values.push_back(f.values(z));
  }
  return values;
}

NoiseLikelihood::FirstStateFit NoiseLikelihood::fit_first_states(
    std::span<const float> simulated) const {
  const FirstStateErrors errors(model_, recorded_, simulated, first_states());
  const JointIntegrand f(model_, errors);
  FirstStateFit fit;
  fit.values = f.values(mode_of(f, f.guess()));
  fit.errors = errors.first_errors(fit.values);
  fit.states = from_first_states(model_, simulated, first_states(), fit.errors);
  return fit;
}

double NoiseLikelihood::distance(std::span<const float> one, std::span<const float> other,
                                 const std::vector<NoiseValues>& values) const {
  double sum = 0.0;
  for (Index c = 0; c < model_.num_states(); ++c) {
    const ChannelErrors errors = channel_errors(model_, one, other, c, -1);
    sum += independent(errors, values[static_cast<std::size_t>(c)]).square().sum();
  }
  return std::sqrt(sum);
}

double NoiseLikelihood::misfit(std::span<const float> simulated,
                               const std::vector<NoiseValues>& values) const {
  const RowMatrix& first_errors = first_states().errors;
  const std::vector<char> restarts = restarts_of_rollouts(model_);
  double sum = 0.0;
  for (Index c = 0; c < model_.num_states(); ++c) {
    const NoiseValues& at = values[static_cast<std::size_t>(c)];
    ChannelErrors errors = channel_errors(model_, recorded_, simulated, c, -1);
    begin_with(first_errors.col(c), restarts, errors);
    sum += independent(errors, at).square().sum();
    sum += (1.0 - at.correlation * at.correlation) * first_errors.col(c).squaredNorm() /
           (at.scale * at.scale);
  }
  return sum;
}

ErrorMemory NoiseLikelihood::error_memory(std::span<const float> simulated) const {
  const Index channels = model_.num_states();
  FirstStateFit fit;
  if (infers_first_states()) {
    fit = fit_first_states(simulated);
  } else {
    fit.values.resize(static_cast<std::size_t>(channels));
    fit.states.assign(simulated.begin(), simulated.end());
  }
  const std::vector<char> restarts = restarts_of_rollouts(model_);
  RowMatrix scores_of_states(std::ssize(restarts), channels);
  for (Index c = 0; c < channels; ++c) {
    const auto i = static_cast<std::size_t>(c);
    const ChannelNoise& noise = model_.channels()[i];
    ChannelErrors errors = channel_errors(model_, recorded_, fit.states, c, -1);
    if (infers_first_states()) {
      begin_with(fit.errors.col(c), restarts, errors);
    } else {
      const ChannelIntegrand f(noise, errors);
      fit.values[i] = f.values(mode_of(f, f.guess()));
    }
    const NoiseValues& at = fit.values[i];
    scores_of_states.col(c) = scores(noise, at, independent(errors, at));
  }
  ErrorMemory result = memory_of(scores_of_states, restarts);
  // As many errors of a channel as there are first states have gone into them.
  const double share =
      static_cast<double>(fit.errors.rows()) / static_cast<double>(restarts.size());
  result.size /= 1.0 - std::min(share, 0.5);
  return result;
}

}  // namespace npdr::sim
