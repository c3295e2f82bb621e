/// Training task of one round: a network, its first weights, and the objective that belongs to the
/// algorithm. Private to inference/algorithms.
#pragma once

#include <memory>

#include "inference/algorithms/posterior_estimation.h"

namespace npdr::inference {

/// Network, data and objective of a training. Not thread-safe.
class RoundTask {
 public:
  virtual ~RoundTask() = default;
  virtual Objective& objective() = 0;
  virtual Index num_parameters() const = 0;
  /// Weights of a network that hasn't been trained in an earlier round.
  virtual Parameters<float> initial_parameters(const StreamId& id) const = 0;
};

/// Rows of the data, ascending, and how much each of all rows (N) counts for q(u | z): empty, all
/// count the same.
struct LearnedRows {
  std::vector<std::uint32_t> rows = {};             ///< of q, or a ratio
  std::vector<std::uint32_t> likelihood_rows = {};  ///< of a likelihood: any proposal's
  std::vector<std::uint32_t> judging = {};          ///< that judge the powers of a pool of both
  VectorF weights = {};

  const std::vector<std::uint32_t>& of(NetworkRole role) const {
    return role == NetworkRole::likelihood ? likelihood_rows : rows;
  }
};

std::vector<std::uint32_t> all_rows(const RoundData& data);
/// Rows that each round has drawn, (R); those that failed count, too: what rows are draws of is the
/// mixture of what was drawn, whichever of it is left.
std::vector<Index> num_drawn(const RoundData& data);

/// For q those of the last round ("npe_a"); all, weighted as draws of the prior
/// ("npe_b"); those of npe_nle.h; or all. `are_pooled`: powers of a pool are judged.
LearnedRows learned_rows(const PosteriorEstimationConfig& config, const RoundData& data,
                         bool are_pooled);

/// The task of the algorithm for `parts`, whose estimator and transform are set, on these rows and
/// with these weights. Keeps references to its arguments.
std::unique_ptr<RoundTask> make_round_task(const PosteriorEstimationConfig& config,
                                           const RoundData& data, const LearnedRows& learned,
                                           const NetworkParts& parts, const StreamId& id);

}  // namespace npdr::inference
