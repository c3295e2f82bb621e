#include "inference/direct_posterior.h"

#include "core/error.h"
#include "core/parallel.h"
#include "inference/estimators/mixture_density_network.h"
#include "inference/row_blocks.h"

namespace npdr::inference {

EmbeddedEstimator<float> make_network(const EstimatorConfig& config, Index num_inputs,
                                      Index trained_features, Index dimension,
                                      std::uint64_t structure_seed) {
  const StreamId structure{structure_seed, "network_structure", 0, 0, 0};
  return {num_inputs, trained_features, config, dimension, structure};
}

EmbeddedEstimator<float> make_network(const NetworkParts& parts) {
  const Index dimension = parts.prior.dimension(), features = parts.transform.num_outputs();
  if (parts.role == NetworkRole::likelihood) {
    return make_network(parts.estimator, dimension, 0, features, parts.structure_seed);
  }
  return make_network(parts.estimator, features, parts.trained_features, dimension,
                      parts.structure_seed);
}

DirectPosterior::DirectPosterior(NetworkParts given)
    : NetworkPosterior(std::move(given)),
      network_(std::make_shared<const EmbeddedEstimator<float>>(make_network(parts()))) {
  const Index weights = parts().parameters.size(), features = parts().x_o.size();
  if (weights != network_->num_parameters() || features != parts().transform.num_inputs()) {
    throw ShapeError("posterior: " + std::to_string(weights) + " weights and " +
                     std::to_string(features) + " features, must be " +
                     std::to_string(network_->num_parameters()) + " and " +
                     std::to_string(parts().transform.num_inputs()));
  }
  parts().transform.apply(parts().x_o.transpose(), z_);
  if (parts().estimator.kind == EstimatorKind::mdn) mixture_ = mixture_of_network();
  if (!parts().proposal) return;
  if (!mixture_ || parts().proposal->dimension() != prior().dimension()) {
    throw ShapeError("posterior: only a mixture can be divided by a proposal of its dimension");
  }
  mixture_ = corrected_for_proposal(*mixture_, *parts().proposal);
}

Samples DirectPosterior::draw(Index n, const StreamId& id) const {
  if (parts().proposal) return {prior().to_theta(mixture_->sample(n, id))};
  RowMatrix u(num_blocks(n) * kBlockRows, prior().dimension());
  parallel_for(num_blocks(n), [&](Index b) {
    StreamId block = id;
    block.row += static_cast<std::uint64_t>(b * kBlockRows);
    u.middleRows(b * kBlockRows, kBlockRows) =
        network_->sample(parts().parameters, z_, kBlockRows, block).cast<double>();
  });
  return {prior().to_theta(u.topRows(n))};
}

Vector DirectPosterior::network_log_prob(const RowMatrixF& u) const {
  Vector result;
  evaluate_in_blocks(
      u,
      [&](const RowMatrixF& block, VectorF& log_prob) {
        auto scratch = network_->make_scratch();
        network_->log_prob(parts().parameters, block, z_, scratch, log_prob);
      },
      result);
  return result;
}

Vector DirectPosterior::log_prob(const RowMatrix& theta) const {
  const RowMatrix u = prior().to_normal(theta);
  const Vector log_prob =
      parts().proposal ? mixture_->log_prob(u) : network_log_prob(u.cast<float>());
  return log_prob + prior().log_det_to_normal(theta);
}

GaussianMixture DirectPosterior::mixture_of_network() const {
  const auto& mixtures = dynamic_cast<const MixtureDensityNetwork<float>&>(network_->estimator());
  auto scratch = network_->make_scratch();
  auto& heads = static_cast<MixtureScratch<float>&>(*scratch.estimator);
  mixtures.forward_heads(parts().parameters, network_->embed(parts().parameters, z_, scratch),
                         heads);
  return mixtures.mixture(heads, 0);
}

const GaussianMixture& DirectPosterior::mixture() const {
  if (!mixture_) throw Error("posterior: its density estimator is not a mixture");
  return *mixture_;
}

}  // namespace npdr::inference
