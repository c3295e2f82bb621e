/// What verdicts on evaluated samples share.
#pragma once

#include <string>
#include <vector>

#include "pipeline/report/verdicts.h"

namespace npdr::pipeline {

/// Those of one method, in the order of seeds.
using Runs = std::vector<const EvaluatedRun*>;

Verdict too_few_samples(Check check, Index count);

/// What would let a method learn more of its observation.
std::string advice_to_learn(const ReportData& data, const std::string& method);

}  // namespace npdr::pipeline
