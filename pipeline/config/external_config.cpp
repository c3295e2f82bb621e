#include "pipeline/config/external_config.h"

namespace npdr::pipeline {
namespace {

// Of a program of the user's.
constexpr SourceTraits of_program(SourceTraits traits) {
  traits.calls_program = traits.takes_seeds = true;
  traits.advice =
      "see the logs beside its shards, narrow the prior (values beyond 3.4e38 have diverged, too)";
  return traits;
}

constexpr std::array<SourceTraits, 7> kTraits = {{
    {.is_built_in = true,
     .describes_itself = true,
     .advice = "narrow the prior, use more simulator.substeps"},
    of_program({.kind = SourceKind::command, .name = "command", .gives_motion = false}),
    of_program({.kind = SourceKind::motion_command, .name = "command"}),
    of_program({.kind = SourceKind::worker, .name = "worker"}),
    {.kind = SourceKind::library,
     .name = "library",
     .describes_itself = true,
     .takes_seeds = true,
     .advice = "narrow the prior, or the library's limits of parameters"},
    {.kind = SourceKind::mjcf,
     .name = "MJCF model",
     .describes_itself = true,
     .takes_seeds = true,
     .advice = "narrow the prior, use a smaller option timestep"},
    {.kind = SourceKind::dataset,
     .name = "dataset",
     .gives_motion = false,
     .simulates = false,
     .advice = "mend the dataset or the prior (rows outside of one that is narrower on purpose are "
               "left out under a higher limits.max_failed_fraction)"},
}};

}  // namespace

const SourceTraits& traits_of(SourceKind kind) { return kTraits[static_cast<std::size_t>(kind)]; }

SourceKind ExternalConfig::kind() const {
  if (command) return states.empty() ? SourceKind::command : SourceKind::motion_command;
  if (worker) return SourceKind::worker;
  if (library) return SourceKind::library;
  if (mjcf) return SourceKind::mjcf;
  return dataset ? SourceKind::dataset : SourceKind::built_in;
}

}  // namespace npdr::pipeline
