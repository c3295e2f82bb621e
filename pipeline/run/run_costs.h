/// What artefacts cost, to say how long a run still takes: a simulation of ten thousand rows and a
/// proposal count as one artefact each, and not as one another.
#pragma once

#include <map>
#include <optional>
#include <utility>

#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// Costs by stage and method. Simulations cost by the row.
class RunCosts {
 public:
  /// Learns from artefacts that are there: one of each stage and method.
  explicit RunCosts(const Plan& plan);

  void learn(const Node& node, double core_seconds);

  /// Core-seconds that `node` will probably cost: as others of its stage and method, or of its
  /// stage; none where there are none.
  std::optional<double> expected(const Node& node) const;

 private:
  struct Mean {
    double sum = 0.0;
    double count = 0.0;
  };
  double size_of(const Node& node) const;

  const Plan& plan_;
  std::map<std::pair<Stage, std::string>, Mean> means_;  // by method, and of all of them
};

/// What is left of a run, artefact by artefact.
class WorkLeft {
 public:
  /// `core_seconds`: what it still costs; none: unknown.
  void add(Stage stage, std::optional<double> core_seconds);

  /// Share of the run's work that is done: `num_made` artefacts, `done` core-seconds. What nothing
  /// tells the cost of is taken to cost as much as others do on average, if it is one of its stage
  /// and, but for the report, no more of these are left than others; none otherwise.
  std::optional<double> share_done(double done, Index num_made) const;

 private:
  double known_ = 0.0;  // core-seconds
  Index num_known_ = 0;
  std::map<Stage, Index> num_unknown_;
};

}  // namespace npdr::pipeline
