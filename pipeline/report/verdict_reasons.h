/// Words of verdicts: what a diagnosis has found wrong, and what to do about it.
#pragma once

#include <string>
#include <vector>

#include "pipeline/report/data.h"

namespace npdr::pipeline {

/// Diagnoses of one method, in the order of seeds.
using DiagnosisRuns = std::vector<const ResultOf<Diagnosis>*>;

/// Of a check with a p-value that has failed.
std::string failure_reason(Check check, const Study& study, const ResultOf<Diagnosis>& run);

/// Why a check with a p-value could hardly have failed at that level; "": it could have.
std::string too_little_to_tell(Check check, const Diagnosis& diagnosis, double level);

/// Of the first training that didn't end well; "": all did.
std::string training_reason(const DiagnosisRuns& runs, const inference::TrainingConfig& training);

}  // namespace npdr::pipeline
