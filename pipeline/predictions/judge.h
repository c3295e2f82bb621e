/// Measures parameters by the study's metrics, on the rollouts that inference saw and on those that
/// were held out.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "pipeline/predictions/prediction.h"

namespace npdr::pipeline {

class Judge {
 public:
  /// Reads what `node` needs of the target domain.
  Judge(const Plan& plan, const Node& node);

  /// Predicts the rollouts that inference saw.
  const Predictor& seen() const { return seen_; }
  /// Predicts those that were held out; nullptr: there are none.
  const Predictor* held_out() const { return held_out_ ? &*held_out_ : nullptr; }

  /// Metrics of complete parameters (n, P), by the names of measured_names(), (n) each; none for a
  /// source that simulates nothing. `first`: see RowSimulator.
  std::map<std::string, Vector> measure(const RowMatrix& complete, const StreamId& first) const;
  /// The same of rollouts that have been simulated; `held_out` may be empty where there are none.
  std::map<std::string, Vector> measure(const sim::Trajectories& seen,
                                        const sim::Trajectories& held_out) const;
  /// Held-out rollouts of complete parameters (n, P); empty where there are none.
  sim::Trajectories simulate_held_out(const RowMatrix& complete, const StreamId& first) const;
  /// One parameter vector (P).
  std::map<std::string, double> measure_one(const Vector& complete, const StreamId& id) const;

 private:
  const Plan& plan_;
  Predictor seen_;
  std::optional<Predictor> held_out_;
};

}  // namespace npdr::pipeline
