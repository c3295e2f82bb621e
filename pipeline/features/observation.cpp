#include "pipeline/features/observation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pipeline/artefacts/recording.h"
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

Target read_target(const Plan& plan, const Node& node, Index num_rollouts) {
  Target target = read_target_artefact(plan.input(node, "target"));
  return num_rollouts > 0 ? target.first(num_rollouts) : target;
}

Target read_seen_target(const Plan& plan, const Node& node) {
  const Use& use = node.uses.front();
  return read_target(plan, node, num_rollouts_seen(plan.study.method(use.method), use));
}

Target make_seen_target(const Plan& plan) {
  const Target all = plan.study.target.truth ? plan.source->behave({}) : plan.target;
  return all.first(all.num_rollouts() - plan.study.target.held_out);
}

std::optional<Target> read_held_out(const Plan& plan, const Node& node) {
  const Node* held_out = plan.find_input(node, "held_out");
  if (held_out == nullptr) return std::nullopt;
  return read_target_artefact(*held_out);
}

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

Vector summarize(std::span<const float> picked, const inference::SeriesSelection& selection) {
  constexpr Index num_values = 5;
  const Index steps = selection.num_steps(), channels = selection.num_channels();
  if (steps == 1) {
    return Eigen::Map<const VectorF>(picked.data(), selection.num_values()).cast<double>();
  }
  Vector result(num_values * selection.num_rollouts * channels);
  Index next = 0;
  for (Index h = 0; h < selection.num_rollouts; ++h) {
    const Eigen::Map<const RowMatrixF> rollout(picked.data() + h * steps * channels, steps,
                                               channels);
    for (Index c = 0; c < channels; ++c) {
      const Vector values = rollout.col(c).cast<double>();
      const double mean = values.mean();
      const double deviation = std::sqrt((values.array() - mean).square().mean());
      result.segment(next, num_values) << mean, deviation, values.minCoeff(), values.maxCoeff(),
          values(steps - 1);
      next += num_values;
    }
  }
  return result;
}

std::vector<std::string> summary_names(const inference::SeriesSelection& selection,
                                       const std::vector<Channel>& channels) {
  std::vector<std::string> names;
  for (Index h = 0; h < selection.num_rollouts; ++h) {
    for (const Index c : selection.channels) {
      if (selection.num_steps() == 1) {
        names.push_back(channels[static_cast<std::size_t>(c)].label);
        continue;
      }
      for (const char* what : {"mean", "deviation", "minimum", "maximum", "last"}) {
        names.push_back(fmt::format("rollout {}, {}: {}", h + 1,
                                    channels[static_cast<std::size_t>(c)].label, what));
      }
    }
  }
  return names;
}

}  // namespace npdr::pipeline
