/// Search for the parameters of a policy from returns alone, by a Gaussian over them.
///
/// An iteration asks for candidates phi_i ~ N(mean, Sigma), has their returns R_i measured, and
/// tells them: the optimizer moves mean and Sigma to where returns were large. What a return is
/// worth the caller decides: here it is the mean over domain parameters and initial states, the
/// same for all candidates of an iteration.
///
/// Everything an optimizer knows is its state, of plain matrices: one made of a stored state goes
/// on with the same bits.
#pragma once

#include <memory>

#include "core/random.h"
#include "core/types.h"
#include "inference/policy_search/policy_search_config.h"

namespace npdr::inference {

struct PolicySearchState {
  Index iteration = 0;      ///< iterations that are done
  Vector mean;              ///< (Q) the current policy
  RowMatrix covariance;     ///< (Q, Q) of the exploration
  RowMatrix best_policies;  ///< (B, Q) of all iterations, the best first
  Vector best_returns;      ///< (B)
};

/// A search that is under way. Not thread-safe; const calls are.
class PolicyOptimizer {
 public:
  virtual ~PolicyOptimizer() = default;

  /// The policies of this iteration, (1 + population, Q): the current one, then candidates.
  /// Candidate i depends on seed, iteration and i alone; `id` names the seed (and round). Asking
  /// changes nothing.
  RowMatrix ask(const StreamId& id) const;

  /// Ends the iteration: `policies` as ask() gave them, and their returns (1 + population). Throws
  /// ShapeError for other shapes, InputError for a return that isn't finite.
  void tell(const RowMatrix& policies, const Vector& returns);

  const Vector& current() const { return state_.mean; }
  const PolicySearchState& state() const { return state_; }

 protected:
  /// Throws InputError for a config out of range, ShapeError for a state whose parts don't go
  /// together, or hold more best policies than num_best. Keeps num_best policies of all iterations.
  PolicyOptimizer(const PolicySearchConfig& config, PolicySearchState state, Index num_best);

  const PolicySearchConfig& config() const { return config_; }

  /// The next mean and covariance; the best policies already count this iteration's.
  virtual void update(const RowMatrix& policies, const Vector& returns,
                      PolicySearchState& state) = 0;

 private:
  void remember_best(const RowMatrix& policies, const Vector& returns);

  PolicySearchConfig config_;
  PolicySearchState state_;
  Index num_best_;
};

/// A search that begins at the policy `initial` (Q), or goes on from a stored state. Throws
/// InputError for a config out of range or a policy that isn't finite.
std::unique_ptr<PolicyOptimizer> make_policy_optimizer(const PolicySearchConfig& config,
                                                       const Vector& initial);
std::unique_ptr<PolicyOptimizer> make_policy_optimizer(const PolicySearchConfig& config,
                                                       const PolicySearchState& state);

}  // namespace npdr::inference
