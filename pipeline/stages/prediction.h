/// Posterior predictive simulation: samples of theta -> rollouts -> metrics.
#pragma once

#include <map>
#include <memory>
#include <string>

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

  /// Rollouts of theta (n, D) in the order of the study's prior.
  sim::Trajectories simulate(const RowMatrix& theta) const;

  /// The study's metrics of simulated rollouts by name, (n) each; NaN where a row failed.
  std::map<std::string, Vector> measure(const sim::Trajectories& trajectories) const;

  /// RMSE of each row of theta, (n); NaN where it failed.
  Vector rmse(const RowMatrix& theta) const;

  /// The study's nominal parameters and, for a simulated target, the truth, (D) each.
  Vector nominal() const;
  Vector truth() const;

 private:
  Vector pick(const std::map<std::string, double>& values) const;

  const Plan& plan_;
  Target target_;
  std::unique_ptr<sim::Simulator> simulator_;
};

analysis::TrajectoryView view_of(const sim::Trajectories& trajectories);

}  // namespace npdr::pipeline
