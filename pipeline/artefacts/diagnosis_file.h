/// Diagnosis artefacts: what the checks of a method's posteriors have found, a group per check; and
/// checkpoints, the ranks that an interrupted one goes on from.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "inference/diagnostics/calibration.h"
#include "inference/diagnostics/coverage.h"
#include "inference/diagnostics/failure_dependence.h"
#include "inference/diagnostics/local_c2st.h"
#include "inference/diagnostics/predictive_check.h"
#include "inference/diagnostics/sbc.h"
#include "inference/diagnostics/training_check.h"
#include "inference/prior.h"
#include "pipeline/artefacts/schemas.h"

namespace npdr::pipeline {

struct SbcResult {
  RowMatrixX<std::int64_t> ranks;  ///< (n, D)
  RowMatrix levels;                ///< (n, D), spread over (0, 1)
  inference::Sbc test;
};

struct CoverageResult {
  VectorX<std::int64_t> ranks;  ///< (n)
  Vector levels;                ///< (n), spread over (0, 1)
  inference::Coverage coverage;
};

struct PredictiveResult {
  std::vector<std::string> names;  ///< (S)
  Vector observed;                 ///< (S)
  Vector median;                   ///< (S) of the predictions
  Index num_failed = 0;            ///< predictions that were left out
  inference::PredictiveCheck check;
};

struct WidthResult {
  Vector excess;           ///< (D) inference::excess_width(); 0 where nothing is random
  bool is_random = false;  ///< whether simulations of the same parameters differ
};

/// The simulations of one round; the p-value is of all rounds.
struct FailureResult {
  Index round = 0;
  std::string parameter;  ///< that differs most
  std::string other;      ///< whose product with it does, or itself: its square; "": neither
  inference::FailureDependence test;
};

/// Results of the checks; those that weren't asked for are empty.
struct Diagnosis {
  Index num_samples = 0;
  Index num_simulations = 0;  ///< of calibration, without the failed ones
  Index num_failed = 0;
  Vector truth_log_prob;  ///< (n) posterior density of their parameters [nats]; may be NaN
  std::optional<SbcResult> sbc;
  std::optional<CoverageResult> coverage;
  std::optional<CoverageResult> tarp;
  std::optional<inference::LocalC2st> local_c2st;
  std::optional<PredictiveResult> predictive;
  std::optional<WidthResult> width;
  std::optional<inference::OutOfDistribution> ood;
  std::optional<FailureResult> failures;
  std::optional<inference::TrainingCheck> training;
  Index max_epochs = 0;                              ///< that training may have had
  std::vector<inference::Marginal> parameters = {};  ///< of the ranks' columns; not read

  /// By the names of checks; "training" has none.
  std::map<std::string, double> p_values() const;
};
void describe(Layout f, Diagnosis& diagnosis);

struct DiagnosisCheckpoint {
  inference::CalibrationRanks ranks;
  Cost cost;  ///< of the work that led here
};
void describe(Layout f, DiagnosisCheckpoint& checkpoint);

/// Without any rank where there is no checkpoint. Throws InputError for one that is damaged, or of
/// another number of samples or parameters (n, D).
DiagnosisCheckpoint read_diagnosis_checkpoint(const ArtefactFile& artefact, const RowMatrix& theta,
                                              Index num_samples);

}  // namespace npdr::pipeline
