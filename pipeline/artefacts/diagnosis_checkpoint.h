/// Checkpoints of diagnoses: the ranks that an interrupted one goes on from.
#pragma once

#include "inference/diagnostics/calibration.h"
#include "pipeline/artefacts/schemas.h"

namespace npdr::pipeline {

struct DiagnosisCheckpoint {
  inference::CalibrationRanks ranks;
  Cost cost;  ///< of the work that led here
};
void describe(Layout f, DiagnosisCheckpoint& checkpoint);

/// Without any rank where there is no checkpoint. Throws InputError for one that is damaged, or not
/// of simulations with these parameters (n, D), of whose posteriors `num_samples` are drawn.
DiagnosisCheckpoint read_diagnosis_checkpoint(const ArtefactFile& artefact, const RowMatrix& theta,
                                              Index num_samples);

}  // namespace npdr::pipeline
