/// What becomes known of a diagnosis while it ranks: progress, and checkpoints.
#pragma once

#include "pipeline/artefacts/diagnosis_file.h"
#include "pipeline/plan/plan.h"
#include "pipeline/process/progress.h"
#include "pipeline/stages/checkpoint_times.h"

namespace npdr::pipeline {

/// The hook of inference::rank_truths(). Keeps references.
class RankReport {
 public:
  /// Goes on from `earlier`, of `num_simulations`.
  RankReport(const Plan& plan, const Node& node, Index num_simulations,
             const DiagnosisCheckpoint& earlier);

  /// Writes a checkpoint now and then, and where a stop is asked for, and throws Checkpointed then.
  void operator()(const inference::CalibrationRanks& ranks);

  static ArtefactFile checkpoint(const Plan& plan, const Node& node);

 private:
  const Plan& plan_;
  const Node& node_;
  Progress progress_;
  Cost earlier_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point saved_ = start_;
};

}  // namespace npdr::pipeline
