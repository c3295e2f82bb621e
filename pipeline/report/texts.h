/// Paragraphs of a report.
#pragma once

#include <string>

#include "pipeline/findings/data.h"

namespace npdr::pipeline {

/// Lines to copy: where the posteriors are, with what their checks say, and commands that sample
/// and read that of which the fewest checks fail.
std::string next_steps(const ReportData& data);

/// What posteriors are that two kinds of networks make together, for people who didn't choose them,
/// since they are the default; "" without any.
std::string pooling_text(const Study& study);

}  // namespace npdr::pipeline
