/// Policy search: the tables [policy] and [policy.grid] of a study.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/types.h"

namespace npdr::pipeline {

/// One axis of the grid that policies are tested on: a domain parameter, and its values.
struct PolicyGridAxis {
  std::string parameter;      ///< "": there is no grid
  std::vector<double> range;  ///< [low, high], of `steps` values at equal distances
  Index steps = 7;
  std::vector<double> values;  ///< in place of range and steps

  bool is_used() const { return !parameter.empty(); }
  /// The values, ascending.
  std::vector<double> points() const;
};

struct PolicyGrid {
  PolicyGridAxis x;
  PolicyGridAxis y;

  bool is_used() const { return x.is_used() && y.is_used(); }
};

struct PolicyConfig {
  std::string optimizer;                  ///< a name of policy_optimizer_names(); "": no search
  Index population = 25;                  ///< candidates per search iteration
  Index num_domain_parameters = 50;       ///< that each candidate is tried on, per iteration
  Index num_initial_states = 4;           ///< of each of them
  Index num_test_states = 100;            ///< initial states of a policy's test
  Index num_steps = 0;                    ///< of a rollout; 0: the simulator's own
  std::map<std::string, double> initial;  ///< policy parameters that begin elsewhere
  std::map<std::string, double> model;    ///< of the policy's own model: what isn't nominal
  double initial_std = 2.0;               ///< of the exploration, in the search's coordinates
  double min_std = 0.02;                  ///< it never falls below
  Index num_importance_samples = 10;      ///< "power": the best rollouts that count
  double elite_fraction = 0.25;           ///< "cross_entropy": candidates that count
  double smoothing = 0.7;                 ///< "cross_entropy": weight of the new distribution
  PolicyGrid grid;

  bool is_used() const { return !optimizer.empty(); }
};

}  // namespace npdr::pipeline
