#include "inference/embeddings/embedding.h"

#include <algorithm>

#include "core/error.h"
#include "core/text.h"
#include "inference/embeddings/bayessim.h"
#include "inference/embeddings/time_series.h"

namespace npdr::inference {
namespace {

std::vector<Index> channel_indices(const EmbeddingConfig& config, const Target& target) {
  std::vector<std::string> labels;
  for (const Channel& channel : target.state_channels) labels.push_back(channel.label);
  std::vector<Index> indices;
  for (const std::string& name : config.channels.empty() ? labels : config.channels) {
    const auto found = std::find(labels.begin(), labels.end(), name);
    if (found == labels.end()) {
      throw InputError("embedding.channels: " + unknown_name("channel", name, labels));
    }
    indices.push_back(found - labels.begin());
  }
  return indices;
}

SeriesSelection select(const EmbeddingConfig& config, const Target& target, Index store_every) {
  if (config.downsample < 1 || config.downsample % store_every != 0) {
    throw InputError(
        "embedding.downsample = " + std::to_string(config.downsample) +
        ", must be a positive multiple of simulator.store_every = " + std::to_string(store_every));
  }
  SeriesSelection selection;
  selection.num_rollouts = target.num_rollouts();
  selection.num_stored = target.num_steps() / store_every;
  selection.num_stored_channels = target.num_states();
  selection.stride = config.downsample / store_every;
  selection.channels = channel_indices(config, target);
  const bool is_vector = config.kind == EmbeddingKind::identity || !config.shape.empty();
  if (!is_vector && selection.num_steps() < 2) {
    throw InputError("embedding.downsample = " + std::to_string(config.downsample) +
                     " leaves fewer than two of the " + std::to_string(target.num_steps()) +
                     " steps of a rollout, must be smaller");
  }
  return selection;
}

}  // namespace

void SeriesSelection::pick(std::span<const float> stored, std::span<float> picked) const {
  auto out = picked.begin();
  for (Index h = 0; h < num_rollouts; ++h) {
    for (Index k = 0; k < num_steps(); ++k) {
      const Index state = h * num_stored + (k + 1) * stride - 1;
      const float* from = stored.data() + state * num_stored_channels;
      for (const Index channel : channels) *out++ = from[channel];
    }
  }
}

std::unique_ptr<Embedding> make_embedding(const EmbeddingConfig& config, const Target& target,
                                          Index store_every) {
  const SeriesSelection selection = select(config, target, store_every);
  switch (config.kind) {
    case EmbeddingKind::delta_steps:
      return std::make_unique<DeltaSteps>(selection);
    case EmbeddingKind::last_step:
      return std::make_unique<LastStep>(selection);
    case EmbeddingKind::bayessim:
      return std::make_unique<BayesSim>(selection, target, config.downsample);
    case EmbeddingKind::convolution:
    case EmbeddingKind::linear:
    case EmbeddingKind::all_steps:
    case EmbeddingKind::identity:
      break;
  }
  return std::make_unique<AllSteps>(selection);
}

std::vector<float> observed_series(const Target& target, Index store_every) {
  std::vector<float> series;
  for (const Rollout& rollout : target.rollouts) {
    for (Index t = store_every; t < rollout.states.rows(); t += store_every) {
      for (Index c = 0; c < rollout.states.cols(); ++c) {
        series.push_back(static_cast<float>(rollout.states(t, c)));
      }
    }
  }
  return series;
}

VectorF observed_features(const Embedding& embedding, const Target& target, Index store_every) {
  std::vector<float> picked(static_cast<std::size_t>(embedding.selection().num_values()));
  embedding.selection().pick(observed_series(target, store_every), picked);
  VectorF x(embedding.num_features());
  embedding.embed(picked, {x.data(), static_cast<std::size_t>(x.size())});
  return x;
}

}  // namespace npdr::inference
