/// Settings of a search for policies.
#pragma once

#include "core/enum_names.h"
#include "core/types.h"

namespace npdr::inference {

enum class PolicyOptimizerKind {
  none,  ///< no search
  power,
  cross_entropy,
};
constexpr auto enum_table(PolicyOptimizerKind) {
  using enum PolicyOptimizerKind;
  return std::to_array<EnumRow<PolicyOptimizerKind>>(
      {{none, ""}, {power, "power"}, {cross_entropy, "cross_entropy"}});
}

/// Defaults are those of Table A5 and of the experiments' public record. The search acts on
/// coordinates of order 1, in which initial_std and min_std are meant.
struct PolicySearchConfig {
  PolicyOptimizerKind kind = PolicyOptimizerKind::power;
  Index population = 25;      ///< candidates an iteration, beside the current policy
  Index num_iterations = 20;  ///< how often a search asks and tells
  double initial_std = 2.0;   ///< of the exploration, in every direction
  double min_std = 0.02;      ///< lower bound of the same

  Index num_importance_samples = 10;  ///< PoWER: best rollouts that make the next mean
  double min_return = 1e-3;           ///< PoWER: smaller returns count as this

  double elite_fraction = 0.25;  ///< cross-entropy: share of the population that is refitted
  double smoothing = 0.7;        ///< cross-entropy: weight of the new fit, (0, 1]
};

/// Throws InputError for a value out of range: names field, value and what is allowed.
void check(const PolicySearchConfig& config);

}  // namespace npdr::inference
