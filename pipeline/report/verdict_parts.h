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

/// That seeds are far apart, about which parameters: most of them are wrong, each as sure as if it
/// were right. Empty where they aren't.
std::string contradiction_of_seeds(const ReportData& data, const std::string& method);

/// That the method is far from another one, about which parameter: of the farthest. Empty where
/// it isn't from any.
std::string contradiction_of_methods(const ReportData& data, const std::string& method);

}  // namespace npdr::pipeline
