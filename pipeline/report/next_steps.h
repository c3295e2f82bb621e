/// What people do with a posterior once they have it.
#pragma once

#include <string>

#include "pipeline/report/data.h"

namespace npdr::pipeline {

/// Lines to copy: where the posteriors are, and commands that sample, judge and read one of them.
std::string next_steps(const ReportData& data);

}  // namespace npdr::pipeline
