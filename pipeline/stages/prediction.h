/// Posterior predictive simulation: samples of theta -> rollouts -> metrics.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "analysis/metrics.h"
#include "analysis/quantiles.h"
#include "analysis/trajectory_view.h"
#include "pipeline/plan/plan.h"
#include "pipeline/stages/row_simulator.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// The study's simulator, keeping every state, against all rollouts of its target.
class Predictor {
 public:
  /// `log`: where a command's output goes.
  Predictor(const Plan& plan, Target target, const std::filesystem::path& log);

  const Target& target() const { return target_; }
  const sim::SimulatorInfo& info() const { return info_; }

  /// What the distance of features is measured in, (F); not needed for rollouts.
  void set_feature_deviation(Vector deviation) { feature_deviation_ = std::move(deviation); }

  /// Rollouts, or features, of complete parameters (n, P); `first`: see RowSimulator. Not for a
  /// study with a dataset.
  sim::Trajectories simulate(const RowMatrix& complete, const StreamId& first = {}) const;

  /// The study's metrics of what was simulated by name, (n) each; NaN where a row failed.
  std::map<std::string, Vector> measure(const sim::Trajectories& trajectories) const;

  /// RMSE of each row of theta (n, D), (n); NaN where it failed.
  Vector rmse(const RowMatrix& theta) const;

  /// All P parameters of the simulator for rows of theta (n, D).
  RowMatrix complete(const RowMatrix& theta) const;
  /// The D parameters of the prior among all P.
  Vector pick(const Vector& complete) const;

  /// All P parameters: the study's nominal ones; `values` in place of some; for a simulated target,
  /// the truth.
  Vector nominal() const { return nominal_with({}); }
  Vector nominal_with(const std::map<std::string, double>& values) const;
  Vector truth() const { return nominal_with(*plan_.study.target.truth); }

 private:
  analysis::MetricsConfig metrics_config() const;

  const Plan& plan_;
  Target target_;
  sim::SimulatorInfo info_;
  std::unique_ptr<RowSimulator> simulator_;  // none: the study has a dataset
  Vector feature_deviation_;
};

/// What a simulator that gives features has given, as (n, F).
Eigen::Map<const RowMatrixF> features_of(const sim::Trajectories& x);

analysis::TrajectoryView view_of(const sim::Trajectories& trajectories);

}  // namespace npdr::pipeline
