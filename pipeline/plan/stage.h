/// The stages of a plan, in the order in which they run: a row each, which names the stage, the
/// executable that makes its artefacts and the part of [cluster] that its jobs ask for.
#pragma once

#include <array>

#include "core/enum_names.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

enum class Stage {
  target,
  held_out,
  propose,
  simulate,
  infer,
  baseline,
  evaluate,
  diagnose,
  policy,
  policy_test,
  report
};

struct StageTraits : EnumRow<Stage> {
  std::string_view program;
  StageResources ClusterConfig::*resources;
  bool uses_threads = true;  ///< more than one is worth while
};

constexpr auto enum_table(Stage) {
  using enum Stage;
  using C = ClusterConfig;
  return std::to_array<StageTraits>({{{target, "target"}, "npdr-propose", &C::prepare, false},
                                     {{held_out, "held_out"}, "npdr-propose", &C::prepare, false},
                                     {{propose, "propose"}, "npdr-propose", &C::prepare, false},
                                     {{simulate, "simulate"}, "npdr-simulate", &C::simulate},
                                     {{infer, "infer"}, "npdr-infer", &C::infer, false},
                                     {{baseline, "baseline"}, "npdr-evaluate", &C::baseline},
                                     {{evaluate, "evaluate"}, "npdr-evaluate", &C::evaluate},
                                     {{diagnose, "diagnose"}, "npdr-diagnose", &C::diagnose},
                                     {{policy, "policy"}, "npdr-policy", &C::policy},
                                     {{policy_test, "policy_test"}, "npdr-policy", &C::policy},
                                     {{report, "report"}, "npdr-report", &C::report, false}});
}

constexpr StageTraits traits_of(Stage stage) {
  return enum_table(stage)[static_cast<std::size_t>(stage)];
}

}  // namespace npdr::pipeline
