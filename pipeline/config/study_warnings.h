/// What in a valid study is probably not what was meant.
#pragma once

#include "core/finding.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// `info`: of the study's simulator.
Findings warnings_of(const Study& study, const sim::SimulatorInfo& info);

}  // namespace npdr::pipeline
