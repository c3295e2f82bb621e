/// Posterior predictive simulation: samples of theta -> rollouts -> metrics.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "analysis/metrics.h"
#include "analysis/quantiles.h"
#include "analysis/trajectory_view.h"
#include "inference/feature_transform.h"
#include "pipeline/features/observation.h"
#include "pipeline/plan/plan.h"
#include "pipeline/sources/row_simulator.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// The study's simulator, keeping every state, against all rollouts of its target.
class Predictor {
 public:
  /// `log`: where a command's output goes.
  Predictor(const Plan& plan, Target target, const std::filesystem::path& log);

  const Target& target() const { return observation_.target(); }
  const Observation& observation() const { return observation_; }

  /// Sets the coordinates, one for each feature, that distances of features are measured in; not
  /// needed for rollouts.
  void set_scale_of_features(inference::FeatureTransform scale) { scale_ = std::move(scale); }

  /// Rollouts, or features, of complete parameters (n, P); `first`: see RowSimulator. Not for a
  /// source that simulates nothing.
  sim::Trajectories simulate(const RowMatrix& complete, const StreamId& first = {}) const;

  /// The study's metrics of what was simulated by name, (n) each; NaN where a row failed.
  std::map<std::string, Vector> measure(const sim::Trajectories& trajectories) const;

  /// RMSE of each row of theta (n, D), (n); NaN where it failed.
  Vector rmse(const RowMatrix& theta) const;

 private:
  analysis::MetricsConfig metrics_config() const;

  const Plan& plan_;
  Observation observation_;
  std::unique_ptr<RowSimulator> simulator_;  // none: nothing can be simulated
  inference::FeatureTransform scale_;
};

analysis::TrajectoryView view_of(const sim::Trajectories& trajectories);

}  // namespace npdr::pipeline
