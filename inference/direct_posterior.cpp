#include "inference/direct_posterior.h"

#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "inference/ensemble.h"
#include "inference/estimators/mixture_density_network.h"
#include "inference/row_blocks.h"

namespace npdr::inference {

EmbeddedEstimator<float> make_network(const EstimatorConfig& config, Index num_inputs,
                                      const TrainedEmbeddingConfig& embedding, Index dimension,
                                      std::uint64_t structure_seed) {
  const StreamId structure{structure_seed, "network_structure", 0, 0, 0};
  return {num_inputs, embedding, config, dimension, structure};
}

EmbeddedEstimator<float> make_network(const NetworkParts& parts) {
  const Index dimension = parts.prior.dimension(), features = parts.transform.num_outputs();
  if (const auto* const direct = std::get_if<DirectParts>(&parts.of_role)) {
    return make_network(parts.estimator, features, direct->embedding, dimension,
                        parts.structure_seed);
  }
  return make_network(parts.estimator, dimension, {}, features, parts.structure_seed);
}

DirectPosterior::DirectPosterior(NetworkParts given) : NetworkPosterior(std::move(given)) {
  for (Index m = 0; m < parts().estimator.num_networks; ++m) {
    NetworkParts one = network_of(parts(), m);
    members_.push_back({make_network(one), std::move(one.parameters)});
  }
  require_weights(parts(), members_.front().network.num_parameters());
  parts().transform.apply(parts().x_o.transpose(), z_);
  if (traits_of(parts().estimator.kind).gives(Estimate::mixture)) mixture_ = mixture_of_networks();
  if (!proposal()) return;
  if (!mixture_ || members_.size() > 1 || proposal()->dimension() != prior().dimension()) {
    throw ShapeError(
        "posterior: only one network's mixture can be divided by a proposal of its dimension");
  }
  mixture_ = corrected_for_proposal(*mixture_, *proposal());
}

// Rows of one network lie in blocks; then each of M samples is of another network, in random order.
Samples DirectPosterior::draw(Index n, const StreamId& id) const {
  if (proposal()) return {prior().to_theta(mixture_->sample(n, id))};
  const Index networks = std::ssize(members_), rows = kBlockRows * networks;
  const Index groups = (n + rows - 1) / rows;
  RowMatrixF drawn(groups * rows, prior().dimension());
  parallel_for(groups * networks, [&](Index b) {
    const Member& member = members_[static_cast<std::size_t>(b % networks)];
    StreamId block = id;
    block.row += static_cast<std::uint64_t>(b * kBlockRows);
    drawn.middleRows(b * kBlockRows, kBlockRows) =
        member.network.sample(member.weights, z_, kBlockRows, block);
  });
  if (networks == 1) return {prior().to_theta(drawn.topRows(n).cast<double>())};
  RowMatrix u(drawn.rows(), drawn.cols());
  for (Index first = 0; first < n; first += networks) {
    StreamId order = within(id, "networks");
    order.row += static_cast<std::uint64_t>(first);
    const Index row =
        first / rows * rows + first % rows / networks;  // of the group's first network
    Index place = first;
    for (const Index m : Stream(order).permutation(static_cast<std::uint32_t>(networks))) {
      u.row(place++) = drawn.row(row + m * kBlockRows).cast<double>();
    }
  }
  return {prior().to_theta(u.topRows(n))};
}

Vector DirectPosterior::networks_log_prob(const RowMatrixF& u) const {
  Vector result;
  evaluate_in_blocks(
      u,
      [&](const RowMatrixF& block, VectorF& log_prob) {
        LogMeanExp mean;
        for (const Member& member : members_) {
          auto scratch = member.network.make_scratch();
          member.network.log_prob(member.weights, block, z_, scratch, log_prob);
          mean.add(log_prob);
        }
        log_prob = mean.result();
      },
      result);
  return result;
}

Vector DirectPosterior::log_prob(const RowMatrix& theta) const {
  const RowMatrix u = prior().to_normal(theta);
  const Vector log_prob = proposal() ? mixture_->log_prob(u) : networks_log_prob(u.cast<float>());
  return log_prob + prior().log_det_to_normal(theta);
}

GaussianMixture DirectPosterior::mixture_of(const Member& member) const {
  const auto& mixtures =
      dynamic_cast<const MixtureDensityNetwork<float>&>(member.network.estimator());
  auto scratch = member.network.make_scratch();
  auto& heads = static_cast<MixtureScratch<float>&>(*scratch.estimator);
  mixtures.forward_heads(member.weights, member.network.embed(member.weights, z_, scratch), heads);
  return mixtures.mixture(heads, 0);
}

GaussianMixture DirectPosterior::mixture_of_networks() const {
  GaussianMixture all = mixture_of(members_.front());
  for (auto member = members_.begin() + 1; member != members_.end(); ++member) {
    const GaussianMixture one = mixture_of(*member);
    const Index before = all.num_components();
    all.log_weights.conservativeResize(before + one.num_components());
    all.log_weights.tail(one.num_components()) = one.log_weights;
    all.means.insert(all.means.end(), one.means.begin(), one.means.end());
    all.precision_factors.insert(all.precision_factors.end(), one.precision_factors.begin(),
                                 one.precision_factors.end());
  }
  all.log_weights.array() -= std::log(static_cast<double>(members_.size()));
  return all;
}

const GaussianMixture& DirectPosterior::mixture() const {
  if (!mixture_) throw Error("posterior: its density estimator is not a mixture");
  return *mixture_;
}

}  // namespace npdr::inference
