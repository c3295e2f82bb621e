/// Posterior predictive simulation: samples of theta -> rollouts -> metrics.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/metrics.h"
#include "analysis/quantiles.h"
#include "analysis/trajectory_view.h"
#include "inference/feature_transform.h"
#include "inference/prior.h"
#include "pipeline/features/observation.h"
#include "pipeline/plan/plan.h"
#include "pipeline/sources/source.h"
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

  /// Rollouts, or features, of complete parameters (n, P); none of a source that simulates nothing.
  /// `first`: see RowSimulator.
  sim::Trajectories simulate(const RowMatrix& complete, const StreamId& first = {}) const;

  /// The study's metrics of what was simulated by name, (n) each; NaN where a row failed.
  std::map<std::string, Vector> measure(const sim::Trajectories& trajectories) const;

 private:
  analysis::Metrics metrics() const {
    return analysis::Metrics(target(), {.segment_length = plan_.study.simulator.segment_length});
  }

  const Plan& plan_;
  Observation observation_;
  std::unique_ptr<RowSimulator> simulator_;  // none: nothing can be simulated
  inference::FeatureTransform scale_;
};

/// What parameters predict; empty where there is nothing to predict, or nothing simulates.
struct PredictedRollouts {
  sim::Trajectories seen;  ///< by inference
  sim::Trajectories held_out;
};

/// Measures parameters by the study's metrics, on the rollouts that inference saw and on those that
/// were held out.
class Judge {
 public:
  /// Reads what `node` needs of the target domain.
  Judge(const Plan& plan, const Node& node);

  /// Predicts the rollouts that inference saw.
  const Predictor& seen() const { return seen_; }
  /// Predicts those that were held out; nullptr: there are none.
  const Predictor* held_out() const { return held_out_ ? &*held_out_ : nullptr; }

  /// Both, of complete parameters (n, P). `first`: see RowSimulator.
  PredictedRollouts simulate(const RowMatrix& complete, const StreamId& first) const;
  /// Metrics by the names of measured_names(), (n) each; none where nothing was simulated.
  std::map<std::string, Vector> measure(const PredictedRollouts& predicted) const;
  /// The same of a single row.
  std::map<std::string, double> measure_one(const PredictedRollouts& predicted) const;

 private:
  Predictor seen_;
  std::optional<Predictor> held_out_;
};

analysis::TrajectoryView view_of(const sim::Trajectories& trajectories);

/// Bounds of each parameter of a prior, (D) both.
struct SearchBox {
  Vector lower;
  Vector upper;
};

/// The prior's bounds, or four deviations around the median where it has none, inside of what is
/// physically possible for the simulator.
SearchBox search_box(const std::vector<inference::Marginal>& prior, const sim::SimulatorInfo& info);

}  // namespace npdr::pipeline
