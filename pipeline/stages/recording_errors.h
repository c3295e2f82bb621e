/// Errors of simulations beside a recording, for least squares. Private to pipeline/stages.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "inference/least_squares/least_squares.h"
#include "inference/prior.h"
#include "pipeline/features/observation.h"
#include "pipeline/plan/plan.h"
#include "pipeline/process/progress.h"
#include "pipeline/sources/source.h"

namespace npdr::pipeline {

/// Errors of stored states over each channel's standard deviation, which is the unit of a problem's
/// scales. Problems refer to it.
class RecordingErrors {
 public:
  /// Keeps a reference to `plan`.
  RecordingErrors(const Plan& plan, const Node& node);

  const inference::Prior& prior() const { return prior_; }
  StreamId id(std::string_view name) const { return within(id_, name); }

  /// [steps] Segments that fits begin with, each twice as long as the one before and shorter than
  /// the study's: motion that forks can't be fitted at once (Bock 1983).
  std::vector<Index> segment_lengths() const;
  /// In segments of that length, which begin in recorded states; 0: as the study replays them. No
  /// channel is fitted better than its sensor's noise, where that is given, or a thousandth of its
  /// deviation.
  inference::LeastSquaresProblem in_segments(Index length);
  /// Whether the first states of segments were measured with noise, as all of a recording are;
  /// those of a simulated truth are exact.
  bool has_noisy_first_states() const { return plan_.study.target.recording.has_value(); }
  /// As the study replays rollouts; the first states of segments are unknown, with the recording's
  /// noise around those that are recorded.
  inference::LeastSquaresProblem from_unknown_states();
  /// (S, C) with the unknowns `own` (S C).
  RowMatrix first_states(const Vector& own) const;

  /// Why simulations failed (RowSimulator::last_failure()).
  std::string last_failure() const { return simulator_->last_failure(); }

 private:
  void open(const Target& target);
  inference::LeastSquaresProblem problem();
  Vector smallest_scales() const;
  Vector rounding();
  Target begun_without(const Vector& own) const;
  RowMatrixF simulate(const RowMatrix& u, Index rows_each = 1);
  RowMatrixF simulate_from(const RowMatrix& u, const RowMatrix& own);
  RowMatrixF of(const RowMatrix& unknowns);

  const Plan& plan_;
  inference::Prior prior_;
  Observation observation_;
  std::filesystem::path log_;
  StreamId id_;
  Progress progress_;
  inference::ErrorsOf errors_of_;
  RowMatrix noise_;                    // (H, C) root mean square
  Eigen::RowVectorXd units_;           // (C)
  std::vector<Index> segment_starts_;  // [steps] of segments that states are stored of
  sim::SimulatorConfig simulator_config_;
  std::unique_ptr<RowSimulator> simulator_;
  bool may_be_refused_ = false;  // by a program: what is asked isn't what the study asks
  Index num_rows_ = 0;
};

}  // namespace npdr::pipeline
