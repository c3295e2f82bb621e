#include "pipeline/features/observation.h"

#include <algorithm>
#include <numeric>

#include "sim/observation_noise.h"

namespace npdr::pipeline {
namespace {

sim::NoiseParameter parameter(double value, const std::optional<std::vector<double>>& prior) {
  return prior ? sim::NoiseParameter{prior->at(0), prior->at(1)} : sim::NoiseParameter{value, 0.0};
}

sim::ChannelNoise channel_noise(const ObservationNoise& noise, const std::string& label) {
  sim::ChannelNoise channel;
  const bool has_own = noise.std && noise.std->contains(label);
  channel.is_in_unit = has_own;
  channel.scale = has_own ? sim::NoiseParameter{noise.std->at(label), 0.0}
                          : parameter(noise.scale, noise.scale_prior);
  channel.is_correlated = noise.correlation || noise.correlation_prior;
  channel.correlation = parameter(noise.correlation.value_or(0.0), noise.correlation_prior);
  channel.is_heavy_tailed = noise.degrees_of_freedom || noise.degrees_of_freedom_prior;
  channel.degrees_of_freedom =
      parameter(noise.degrees_of_freedom.value_or(0.0), noise.degrees_of_freedom_prior);
  return channel;
}

// A behavior of which `part` is: its rollouts by their numbers, any in place of the others.
Target whole_behavior(const Target& part) {
  Target whole = part;
  Index count = 0;
  for (const Rollout& rollout : part.rollouts) count = std::max(count, rollout.number + 1);
  whole.rollouts.assign(static_cast<std::size_t>(count), part.rollouts.front());
  for (const Rollout& rollout : part.rollouts) {
    whole.rollouts[static_cast<std::size_t>(rollout.number)] = rollout;
  }
  return whole;
}

std::vector<float> observed_states(const Study& study, const Target& target) {
  const Index store_every = study.simulator.store_every;
  if (!study.target.truth || study.observation_noise.is_silent()) {
    return inference::observed_series(target, store_every);
  }
  const Target whole = whole_behavior(target);
  std::vector<float> all = inference::observed_series(whole, store_every);
  Stream stream({study.target.seed, "target_observation_noise", 0, 0, 0});
  noise_model(study, whole).add(all, 1, stream);
  const std::ptrdiff_t size = std::ssize(all) / whole.num_rollouts();
  std::vector<float> stored;
  for (const Rollout& rollout : target.rollouts) {
    const auto begin = all.begin() + rollout.number * size;
    stored.insert(stored.end(), begin, begin + size);
  }
  return stored;
}

}  // namespace

sim::NoiseModel noise_model(const Study& study, const Target& target, std::vector<Index> channels) {
  if (channels.empty()) {
    channels.resize(target.state_channels.size());
    std::iota(channels.begin(), channels.end(), Index{0});
  }
  std::vector<sim::ChannelNoise> noise;
  for (const Index c : channels) {
    const std::string& label = target.state_channels[static_cast<std::size_t>(c)].label;
    noise.push_back(channel_noise(study.observation_noise, label));
  }
  return {noise, sim::reference_amplitude(target)(Eigen::all, channels),
          sim::stored_restarts(target.num_steps(), study.simulator.segment_length,
                               study.simulator.store_every)};
}

Observation::Observation(const Study& study, Target target)
    : study_(study),
      target_(std::move(target)),
      noise_(noise_model(study, target_)),
      states_(observed_states(study, target_)) {}

sim::NoiseModel Observation::noise_of(const inference::SeriesSelection& selection) const {
  return noise_model(study_, target_, selection.channels);
}

std::vector<float> Observation::picked(const inference::SeriesSelection& selection) const {
  std::vector<float> picked(static_cast<std::size_t>(selection.num_values()));
  selection.pick(states_, picked);
  return picked;
}

VectorF Observation::x_o(const inference::Embedding& embedding) const {
  VectorF x(embedding.num_features());
  embedding.embed(picked(embedding.selection()), {x.data(), static_cast<std::size_t>(x.size())});
  return x;
}

}  // namespace npdr::pipeline
