/// Values of a population of policies under uncertainty: the objective of domain randomization.
///
/// A policy's value is its mean return over K domain parameters x S initial states,
///   J(phi) = 1 / (K S) sum_k sum_s return(theta_k, s_0^s, phi),
/// the same parameters and states for all policies (common random numbers), so that policies are
/// compared by what they do and not by their luck.
#pragma once

#include "core/types.h"
#include "sim/policy_task.h"

namespace npdr::sim {

/// Values of M policies.
struct PopulationValues {
  Vector mean_return;        ///< (M)
  Vector success_rate;       ///< (M) in [0, 1]
  Vector completion_rate;    ///< (M) share of the rollouts that kept the limits, in [0, 1]
  Index num_impossible = 0;  ///< rows of theta left out: they are physically impossible
};

/// Values of the M rows of policies (M, Q) over the rows of theta (K, P) and initial_states (S, C).
/// A policy's value has the same bits whatever else is in the population, and for any number of
/// threads. Simulates whole policies in blocks of bounded memory. Throws ShapeError for other
/// widths, and InputError when there is no initial state, or no theta that is physically possible.
PopulationValues evaluate_population(const PolicyTask& task, const RowMatrix& policies,
                                     const RowMatrix& theta, const RowMatrix& initial_states);

}  // namespace npdr::sim
