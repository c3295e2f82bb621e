/// Posterior predictive simulation: samples of theta -> rollouts -> metrics.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "analysis/metrics.h"
#include "analysis/quantiles.h"
#include "analysis/trajectory_view.h"
#include "pipeline/plan/plan.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// The study's simulator, keeping every state, against all rollouts of its target.
class Predictor {
 public:
  Predictor(const Plan& plan, Target target);

  const Target& target() const { return target_; }
  const sim::Simulator& simulator() const { return *simulator_; }

  /// Rollouts of complete parameters (n, P).
  sim::Trajectories simulate(const RowMatrix& complete) const;

  /// The study's metrics of simulated rollouts by name, (n) each; NaN where a row failed.
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
  std::unique_ptr<sim::Simulator> simulator_;
};

analysis::TrajectoryView view_of(const sim::Trajectories& trajectories);

}  // namespace npdr::pipeline
