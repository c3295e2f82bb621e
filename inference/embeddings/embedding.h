/// Embeddings: the H rollouts of one simulation -> the feature vector x.
#pragma once

#include <memory>
#include <span>

#include "core/target.h"
#include "core/types.h"
#include "inference/embeddings/embedding_config.h"

namespace npdr::inference {

/// The part of a series that an embedding keeps: every `stride`-th stored state, some channels.
struct SeriesSelection {
  Index num_rollouts = 0;         ///< H
  Index num_stored = 0;           ///< states per rollout in the series, before down-sampling
  Index num_stored_channels = 0;  ///< channels in the series
  Index stride = 1;
  std::vector<Index> channels;  ///< those kept

  Index num_steps() const { return num_stored / stride; }
  Index num_channels() const { return static_cast<Index>(channels.size()); }
  /// State k (0-based) of the kept series: the stored state (k + 1) * stride, counted from 1.
  float value(std::span<const float> series, Index rollout, Index k, Index channel) const;
};

/// x = f(series): a fixed function of one simulation's stored states and the target's actions.
///
/// A series holds (H, T', C) floats, row-major: the states after every `store_every`-th step.
/// "linear" is the fixed part of the trained embedding: all steps; its layer is in the network.
/// Const calls are thread-safe.
class Embedding {
 public:
  virtual ~Embedding() = default;

  /// Number of features F of x.
  virtual Index num_features() const = 0;

  /// series: (H, T', C); x: (F).
  virtual void embed(std::span<const float> series, std::span<float> x) const = 0;
};

/// The embedding of a config for series of `target` that hold every `store_every`-th state.
/// Throws InputError when a channel is unknown, the down-sampling is no multiple of store_every, or
/// fewer than two states are left.
std::unique_ptr<Embedding> make_embedding(const EmbeddingConfig& config, const Target& target,
                                          Index store_every);

/// The series of the target's own states after every `store_every`-th step: (H, T', C).
std::vector<float> observed_series(const Target& target, Index store_every);

}  // namespace npdr::inference
