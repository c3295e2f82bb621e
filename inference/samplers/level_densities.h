/// The points of all levels of importance sampling, weighted as draws of the mixture of their
/// densities (Veach and Guibas 1995; Cornuet et al. 2012): with levels k = 1, ..., K of equally
/// many draws,
///   w(u) = N(u; 0, I) L(u)^b / m(u),   m(u) = 1/K sum_k q_k(u).
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "inference/samplers/importance_state.h"

namespace npdr::inference {

/// Points of several levels, by their number: level after level.
struct MixtureDraws {
  Vector log_ratio;       ///< (n), log of N(u; 0, I) over the mixture of all proposals [nats]
  Vector log_likelihood;  ///< (n) [nats]

  Vector log_weights(double power) const { return log_ratio + power * log_likelihood; }
};

/// Densities of the levels' proposals at the levels' points, each computed once.
class LevelDensities {
 public:
  /// Adds the densities of all proposals at the points of all levels but reported ones, and of
  /// reported levels' own at theirs; forgets levels that are gone.
  void update(const ImportanceState& state);

  /// log q_k (n) of a level's proposal at a level's points [nats].
  const Vector& at(const ImportanceLevel& points, const ImportanceLevel& proposal) const {
    return densities_.at({points.number, proposal.number});
  }
  /// log of a level's weights by its own proposal, for the power that this was fitted to, (n).
  Vector log_weights(const ImportanceLevel& level) const;
  /// Effective share of a level's draws by these weights.
  double efficiency(const ImportanceLevel& level) const;

  /// The points of the first levels.
  MixtureDraws mixture_draws(const std::vector<ImportanceLevel>& levels,
                             std::size_t num_levels) const;
  /// log of N(u; 0, I) L(u)^b over the mixture of some levels' proposals, at the points of all,
  /// (n).
  Vector log_ratios(const std::vector<ImportanceLevel>& levels,
                    const std::vector<std::size_t>& proposals, double power) const;

 private:
  void add(const ImportanceState& state, std::size_t points, std::size_t proposal);
  Vector log_mixture(const std::vector<ImportanceLevel>& levels, std::size_t level,
                     std::size_t num_levels) const;

  // (n), by the numbers of the points' level and of the proposal's.
  std::map<std::pair<Index, Index>, Vector> densities_;
};

/// Points by their number in MixtureDraws, (rows, D); each level has `level_size`.
RowMatrix points_of(const std::vector<ImportanceLevel>& levels, Index level_size,
                    const std::vector<Index>& rows);

}  // namespace npdr::inference
