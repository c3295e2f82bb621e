/// Stages that tests run without the programs.
#pragma once

#include "pipeline/plan/plan.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {

/// Makes all artefacts of a plan up to those of the stage `last`.
inline void run_until(const Plan& plan, Stage last) {
  for (const Node& node : plan.nodes) {
    if (node.stage <= last) run_stage(plan, node);
  }
}

}  // namespace npdr::pipeline
