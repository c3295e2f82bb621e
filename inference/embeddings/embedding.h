/// Embeddings: the H rollouts of one simulation -> the feature vector x.
///
/// In two steps, so that observation noise can be added in between: first the states that the
/// embedding looks at are picked from the stored series, then x is computed from them.
#pragma once

#include <memory>
#include <span>

#include "core/target.h"
#include "core/types.h"
#include "inference/embeddings/embedding_config.h"

namespace npdr::inference {

/// The part of a stored series that an embedding looks at: every `stride`-th state, some channels.
/// A stored series holds (H, T', C) floats, row-major: the states after every store_every-th step.
/// A picked one holds (H, K, C'): state k of it is the stored state (k + 1) stride, counted from 1.
struct SeriesSelection {
  Index num_rollouts = 0;         ///< H
  Index num_stored = 0;           ///< T'
  Index num_stored_channels = 0;  ///< C
  Index stride = 1;
  std::vector<Index> channels;  ///< (C') columns of the stored series

  Index num_steps() const { return num_stored / stride; }  ///< K
  Index num_channels() const { return static_cast<Index>(channels.size()); }
  Index num_values() const { return num_rollouts * num_steps() * num_channels(); }
  void pick(std::span<const float> stored, std::span<float> picked) const;
};

/// x = f(picked series): a fixed function of one simulation's states and the target's actions.
/// Of the trained embeddings it is the fixed part, all steps: their layers are in the network.
/// Const calls are thread-safe.
class Embedding {
 public:
  explicit Embedding(SeriesSelection selection) : selection_(std::move(selection)) {}
  virtual ~Embedding() = default;

  const SeriesSelection& selection() const { return selection_; }

  /// Number of features F of x.
  virtual Index num_features() const = 0;

  /// picked: (H, K, C'); x: (F).
  virtual void embed(std::span<const float> picked, std::span<float> x) const = 0;

 private:
  SeriesSelection selection_;
};

/// The embedding of a config for series of `target` that hold every `store_every`-th state.
/// Throws InputError when a channel is unknown, the down-sampling is no multiple of store_every, or
/// fewer than two states are left, except for "identity": its series are single steps.
std::unique_ptr<Embedding> make_embedding(const EmbeddingConfig& config, const Target& target,
                                          Index store_every);

/// The stored series of the target's own states: after every `store_every`-th step, (H, T', C).
std::vector<float> observed_series(const Target& target, Index store_every);

/// x_o: the embedding of the target's own states.
VectorF observed_features(const Embedding& embedding, const Target& target, Index store_every);

}  // namespace npdr::inference
