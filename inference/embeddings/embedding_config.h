/// Settings of an embedding, as a study gives them.
#pragma once

#include <string>
#include <vector>

#include "core/types.h"

namespace npdr::inference {

/// How the H rollouts of one simulation become the feature vector x.
struct EmbeddingConfig {
  std::string kind = "linear";        ///< a name of embedding_names()
  Index features = 256;               ///< width of the trained layer ("linear" only)
  Index principal_components = 0;     ///< project x on so many of its own first; 0: don't
  Index downsample = 1;               ///< keep every k-th state
  std::vector<std::string> channels;  ///< state channels to keep; empty: all
};

/// "linear", "all_steps", "delta_steps", "last_step", "bayessim", "identity".
std::vector<std::string> embedding_names();
/// The only one for simulators that give a vector x and no rollouts: x as it is.
inline constexpr const char* kIdentityEmbedding = "identity";

}  // namespace npdr::inference
