/// Whether the simulations that failed have other parameters than the good ones.
#pragma once

#include <string>
#include <vector>

#include "pipeline/artefacts/diagnosis_file.h"
#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// Tests each of the simulations: the one where failures depend most on the parameters, its p-value
/// times the number of those with a failed row. Rows of theta that are
/// physically impossible, or beyond the prior, don't count: the study says where they end. Throws
/// InputError.
FailureResult test_failures(const Plan& plan, const std::vector<const Node*>& simulations);

/// "12 of 300 simulations of round 1 failed; their 'a' is 1.9 deviations above that of the others".
std::string words_of(const FailureResult& found);

/// Of one simulation, however many of its rows failed: "their 'a' is 1.9 deviations above that of
/// the others"; "" where a test at a level of 0.001 finds nothing.
std::string where_failures_lie(const Plan& plan, const Node& simulation);

/// What that means, and what to do about it.
inline constexpr const char* kFailureAdvice =
    "Rows that failed are left out, so that posteriors are those of parameters that don't fail: "
    "mend the simulator there, or end the prior where it begins to fail; docs/methods.md says "
    "which posteriors are right all the same";

}  // namespace npdr::pipeline
