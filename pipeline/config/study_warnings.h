/// What in a valid study is probably not what was meant.
#pragma once

#include <string>
#include <vector>

#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// One line each: "study.toml:14:9: warning: ...". `info`: of the study's simulator.
std::vector<std::string> warnings_of(const Study& study, const sim::SimulatorInfo& info);

}  // namespace npdr::pipeline
