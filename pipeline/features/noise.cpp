#include "pipeline/features/noise.h"

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

}  // namespace npdr::pipeline
