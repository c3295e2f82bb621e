/// Settings of an embedding, as a study gives them.
#pragma once

#include <string>
#include <vector>

#include "core/enum_names.h"
#include "core/types.h"

namespace npdr::inference {

enum class EmbeddingKind {
  linear,  ///< all steps, then a layer that is trained with the network
  all_steps,
  delta_steps,  ///< differences of successive steps
  last_step,
  bayessim,  ///< sums over the series
  identity,  ///< x as it is: the only one for simulators that give a vector x and no rollouts
};
constexpr auto enum_table(EmbeddingKind) {
  using enum EmbeddingKind;
  return std::to_array<EnumRow<EmbeddingKind>>({{linear, "linear"},
                                                {all_steps, "all_steps"},
                                                {delta_steps, "delta_steps"},
                                                {last_step, "last_step"},
                                                {bayessim, "bayessim"},
                                                {identity, "identity"}});
}

/// Choice of how the H rollouts of one simulation become the feature vector x.
struct EmbeddingConfig {
  EmbeddingKind kind = EmbeddingKind::linear;
  Index features = 16;                ///< width of the trained layer ("linear" only)
  Index principal_components = 0;     ///< project x on so many of its own first; 0: don't
  Index downsample = 1;               ///< keep every k-th state
  std::vector<std::string> channels;  ///< state channels to keep; empty: all
};

}  // namespace npdr::inference
