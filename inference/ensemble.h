/// Ensembles of networks: posteriors whose density is the mean of those of several networks,
///   q(u | z) = 1/M sum_m q_m(u | z),
/// trained on the same simulations from other first weights, with other orders of the variables,
/// and each with a part of the rows of its own for validation, so that all rows train most of them.
/// Likelihoods are averaged the same way; ratios, which are known up to a constant, can't be.
///
/// Source: Lakshminarayanan, Pritzel and Blundell 2017, "Simple and scalable predictive uncertainty
/// estimation using deep ensembles"; for these posteriors Hermans et al. 2022, "A crisis in
/// simulation-based inference?", where ensembles are less overconfident than their members. By
/// Jensen's inequality the mean's expected log density is at least the members' average.
#pragma once

#include "inference/network_posterior.h"

namespace npdr::inference {

/// Seed of what is random in network m = 0, 1, ... and its training; the first has that of all.
std::uint64_t seed_of_network(std::uint64_t seed, Index m);

/// The parts of network m alone: as if its ensemble were one, without a likelihood. Without weights
/// where `parts` has none.
NetworkParts network_of(const NetworkParts& parts, Index m);

/// The networks' weights, one after the other, as an ensemble's parts hold them.
Parameters<float> joined(const std::vector<Parameters<float>>& weights);

/// Throws ShapeError unless `parts` holds the weights of its networks, each `num_parameters`, and
/// x_o has as many features as its transform.
void require_weights(const NetworkParts& parts, Index num_parameters);

/// log 1/M sum_m exp(values_m) of each row, added one m after the other; NaN where one of them is.
class LogMeanExp {
 public:
  void add(const VectorF& values);
  VectorF result() const;

 private:
  VectorF log_sum_;
  Index count_ = 0;
};

}  // namespace npdr::inference
