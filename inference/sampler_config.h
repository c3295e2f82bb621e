/// Settings of the sampling of posteriors whose density is known up to a constant.
#pragma once

#include "core/enum_names.h"
#include "core/types.h"

namespace npdr::inference {

enum class SamplerKind {
  slice,       ///< Markov chains
  importance,  ///< draws of the prior, resampled by their weight
};
constexpr auto enum_table(SamplerKind) {
  return std::to_array<EnumRow<SamplerKind>>(
      {{SamplerKind::slice, "slice"}, {SamplerKind::importance, "importance"}});
}

struct SamplerConfig {
  SamplerKind kind = SamplerKind::slice;
  Index num_chains = 1000;  ///< "slice": chains side by side
  Index num_warmup = 10;    ///< "slice": sweeps that each chain makes first
  Index thin = 5;           ///< "slice": sweeps between two samples of a chain
  Index num_candidates =
      100'000;  ///< draws of the prior that chains climb from, or that are resampled
};

}  // namespace npdr::inference
