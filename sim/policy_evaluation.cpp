#include "sim/policy_evaluation.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace npdr::sim {
namespace {

// Some 200 bytes a row: 10 MB. A policy with more rollouts than that is a block of its own.
constexpr Index kRowsPerBlock = 50'000;

// Row (k S + s) has theta k and initial state s.
struct Conditions {
  RowMatrix theta;           // (K S, P)
  RowMatrix initial_states;  // (K S, C)
  Index count() const { return theta.rows(); }
};

Conditions all_pairs(const RowMatrix& theta, const RowMatrix& initial_states) {
  const Index states = initial_states.rows();
  Conditions result;
  result.theta.resize(theta.rows() * states, theta.cols());
  for (Index row = 0; row < result.theta.rows(); ++row) {
    result.theta.row(row) = theta.row(row / states);
  }
  result.initial_states = initial_states.replicate(theta.rows(), 1);
  return result;
}

// Every policy under all conditions.
PolicyRollouts run_block(const PolicyTask& task, const RowMatrix& policies,
                         const Conditions& conditions) {
  const Index count = conditions.count();
  RowMatrix repeated(policies.rows() * count, policies.cols());
  for (Index row = 0; row < repeated.rows(); ++row) repeated.row(row) = policies.row(row / count);
  return task.run(conditions.theta.replicate(policies.rows(), 1),
                  conditions.initial_states.replicate(policies.rows(), 1), repeated);
}

void summarize(const PolicyRollouts& rollouts, Index num_steps, Index first, Index count,
               PopulationValues& values) {
  for (Index m = 0; m < rollouts.num_rows() / count; ++m) {
    double sum = 0.0, successes = 0.0, completed = 0.0;
    for (Index row = m * count; row < (m + 1) * count; ++row) {
      const auto r = static_cast<std::size_t>(row);
      sum += rollouts.returns(row);
      successes += rollouts.success[r];
      completed += rollouts.num_steps[r] == num_steps ? 1.0 : 0.0;
    }
    const auto n = static_cast<double>(count);
    values.mean_return(first + m) = sum / n;
    values.success_rate(first + m) = successes / n;
    values.completion_rate(first + m) = completed / n;
  }
}

}  // namespace

PopulationValues evaluate_population(const PolicyTask& task, const RowMatrix& policies,
                                     const RowMatrix& theta, const RowMatrix& initial_states) {
  const std::vector<Index> possible = task.possible_rows(theta);
  if (possible.empty()) {
    throw InputError(fmt::format(
        "policies can't be evaluated: none of {} domain parameters is physically possible",
        theta.rows()));
  }
  if (initial_states.rows() == 0) {
    throw InputError("policies can't be evaluated: there are no initial states");
  }
  const RowMatrix kept = theta(possible, Eigen::all);
  const Conditions conditions = all_pairs(kept, initial_states);
  const Index num_policies = policies.rows(), count = conditions.count();
  PopulationValues values{Vector(num_policies), Vector(num_policies), Vector(num_policies),
                          theta.rows() - kept.rows()};
  const Index block_size = std::max<Index>(kRowsPerBlock / count, 1);
  for (Index first = 0; first < num_policies; first += block_size) {
    const Index rows = std::min(block_size, num_policies - first);
    summarize(run_block(task, policies.middleRows(first, rows), conditions), task.info().num_steps,
              first, count, values);
  }
  return values;
}

}  // namespace npdr::sim
