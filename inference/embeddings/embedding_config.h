/// Settings of an embedding, as a study gives them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/enum_names.h"
#include "core/types.h"

namespace npdr::inference {

enum class EmbeddingKind {
  convolution,  ///< all steps, then convolutions over them, trained with the network
  linear,       ///< all steps, then a layer that is trained with the network
  all_steps,
  delta_steps,  ///< differences of successive steps
  last_step,
  bayessim,  ///< sums over the series
  identity,  ///< x as it is: the only one for simulators that give a vector x and no rollouts
};
constexpr auto enum_table(EmbeddingKind) {
  using enum EmbeddingKind;
  return std::to_array<EnumRow<EmbeddingKind>>({{convolution, "convolution"},
                                                {linear, "linear"},
                                                {all_steps, "all_steps"},
                                                {delta_steps, "delta_steps"},
                                                {last_step, "last_step"},
                                                {bayessim, "bayessim"},
                                                {identity, "identity"}});
}

/// Choice of how the H rollouts of one simulation become the feature vector x.
struct EmbeddingConfig {
  EmbeddingKind kind = EmbeddingKind::all_steps;
  Index features = 16;                ///< width of the trained layer, or of the last of them
  bool average_rollouts = false;      ///< "convolution": mean over rollouts, or over items of x
  Index principal_components = 0;     ///< project x on at most so many of its own first; 0: don't
  Index downsample = 1;               ///< keep every k-th state
  std::vector<std::string> channels;  ///< state channels to keep; empty: all
  /// Of a vector x, for "convolution": items, steps of an item, values of a step. Empty: none.
  std::vector<std::uint64_t> shape;

  /// Whether layers are trained with the network, which only that of a posterior can.
  bool trains_layers() const {
    return kind == EmbeddingKind::convolution || kind == EmbeddingKind::linear;
  }
};

}  // namespace npdr::inference
