/// Policy search: the tables [policy] and [policy.grid] of a study.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/types.h"
#include "inference/policy_search/policy_search_config.h"

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
  Index num_domain_parameters = 50;       ///< that each candidate is tried on, per iteration
  Index num_initial_states = 4;           ///< that each of them is tried from
  Index num_test_states = 100;            ///< initial states of a policy's test
  Index num_steps = 0;                    ///< in a rollout; 0: the simulator's own
  std::map<std::string, double> initial;  ///< policy parameters that begin elsewhere
  std::map<std::string, double> model;    ///< what isn't nominal in the policy's own model
  /// The search; its num_iterations stand elsewhere.
  inference::PolicySearchConfig search = {.kind = inference::PolicyOptimizerKind::none};
  PolicyGrid grid;

  bool is_used() const { return search.kind != inference::PolicyOptimizerKind::none; }
};

}  // namespace npdr::pipeline
