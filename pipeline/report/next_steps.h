/// What people do with a posterior once they have it.
#pragma once

#include <string>

#include "pipeline/findings/data.h"

namespace npdr::pipeline {

/// Lines to copy: where the posteriors are, with what their checks say, and commands that sample
/// and read that of which the fewest checks fail.
std::string next_steps(const ReportData& data);

}  // namespace npdr::pipeline
