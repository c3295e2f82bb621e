#include "pipeline/config/source_traits.h"

#include <array>

namespace npdr::pipeline {

const SourceTraits& traits_of(SourceKind kind) {
  static constexpr std::array<SourceTraits, 3> all = {{
      {.advice = "narrow the prior, use more simulator.substeps"},
      {.kind = SourceKind::command,
       .name = "command",
       .gives_motion = false,
       .calls_program = true,
       .has_nominal = false,
       .advice = "see the logs beside its shards, narrow the prior"},
      {.kind = SourceKind::dataset,
       .name = "dataset",
       .gives_motion = false,
       .simulates = false,
       .has_nominal = false,
       .advice = "check the dataset and the prior"},
  }};
  return all[static_cast<std::size_t>(kind)];
}

}  // namespace npdr::pipeline
