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

/// For q those of the last round ("npe_a"); those that lie where the last round's posterior is,
/// weighted as draws of the prior ("npe_nle", truncated_prior.h); all, weighted likewise ("npe_b");
/// or all. `are_judged`: some of the last round's judge (pool_powers.h), and none learns from them.
LearnedRows learned_rows(const PosteriorEstimationConfig& config, const RoundData& data,
                         bool are_judged);

/// The task of the algorithm for `parts`, whose estimator and transform are set, on these rows and
/// with these weights. Keeps references to its arguments.
std::unique_ptr<RoundTask> make_round_task(const PosteriorEstimationConfig& config,
                                           const RoundData& data, const LearnedRows& learned,
                                           const NetworkParts& parts, const StreamId& id);

}  // namespace npdr::inference
