/// How posteriors are sampled whose density is known up to a constant.
#pragma once

#include <string>
#include <vector>

#include "core/types.h"

namespace npdr::inference {

struct SamplerConfig {
  std::string kind = "slice";  ///< a name of sampler_names()
  Index num_chains = 200;      ///< "slice": chains side by side
  Index num_warmup = 100;      ///< "slice": sweeps that each chain makes first
  Index thin = 5;              ///< "slice": sweeps between two samples of a chain
  Index num_candidates =
      100'000;  ///< draws of the prior that chains begin from, or that are resampled
};

/// "slice" (Markov chains), "importance" (draws of the prior, resampled by their weight).
std::vector<std::string> sampler_names();

}  // namespace npdr::inference
