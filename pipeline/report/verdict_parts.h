/// What verdicts on evaluated samples share.
#pragma once

#include <string>
#include <vector>

#include "pipeline/report/verdicts.h"

namespace npdr::pipeline {

/// Those of one method, in the order of seeds.
using Runs = std::vector<const EvaluatedRun*>;

Verdict too_few_samples(Check check, Index count);

/// Name of parameter d of the prior.
const std::string& name_of_parameter(const ReportData& data, Index d);

/// What would let a method learn more of its observation.
std::string advice_to_learn(const ReportData& data, const std::string& method);

/// Whether a check of calibration, which is of round 1, has failed.
bool is_miscalibrated(const ReportData& data, const std::string& method);

/// Whether the observation is a recording, and the study doesn't say what noise it has, nor that it
/// has none.
bool is_noise_unstated(const Study& study);

/// What [observation_noise] may say that it doesn't yet, in brackets, for "simulator or noise lack
/// something"; "": nothing, or the observation is simulated without noise.
std::string noise_hint(const Study& study);

/// The two parameters whose samples, where the prior is standard normal, correlate most, from 0.95
/// on, and which are less than 0.95 contracted (contraction.h) by themselves: the observation tells
/// their combination. Empty where there are none.
std::string words_of_ridge(const ReportData& data, const std::string& method);

/// That hardly any of the simulations of one round lie where a posterior of the default algorithm
/// is, whose next rounds simulate there alone. Empty where at least 300 do, or more than a
/// twentieth of the prior is, or 2^-D: posteriors of many parameters are a small part of it without
/// being narrow in any.
std::string words_of_region(const ReportData& data, const std::string& method);

/// That seeds are far apart, about which parameters: most of them are wrong, each as sure as if it
/// were right. Empty where they aren't.
std::string contradiction_of_seeds(const ReportData& data, const std::string& method);

/// Which other methods of the study are far from this one, each with the parameter about which it
/// is farthest. Empty where none is.
std::string contradiction_of_methods(const ReportData& data, const std::string& method);

}  // namespace npdr::pipeline
