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

/// The rows of the data that are learned from, ascending, and how much each of all rows (N) counts
/// for q(u | z): empty, all count the same.
struct LearnedRows {
  std::vector<std::uint32_t> rows;
  VectorF weights;
};

/// Those of the last round ("npe_a"); those that lie where the last round's posterior is, weighted
/// as draws of the prior ("npe_nle", truncated_prior.h); all, weighted likewise ("npe_b"); or all.
LearnedRows learned_rows(const PosteriorEstimationConfig& config, const RoundData& data);

/// The task of the algorithm for `parts`, whose estimator and transform are set, on these rows and
/// with these weights. Keeps references to its arguments.
std::unique_ptr<RoundTask> make_round_task(const PosteriorEstimationConfig& config,
                                           const RoundData& data, const LearnedRows& learned,
                                           const NetworkParts& parts, const StreamId& id);

}  // namespace npdr::inference
