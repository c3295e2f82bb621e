/// A posterior that a density estimator, or an ensemble of them (ensemble.h), gives directly (the
/// NPE family):
///   log p(theta | x_o) = log q(u(theta) | z_o) + log |du / dtheta|.
/// With a proposal p~ in its parts (NPE-A), q stands for the proposal's posterior, and
///   p(u | x_o) ~ q(u | z_o) N(u; 0, I) / p~(u),
/// a mixture of Gaussians again (gaussian_mixture.h).
#pragma once

#include "inference/estimators/embedded_estimator.h"
#include "inference/network_posterior.h"

namespace npdr::inference {

class DirectPosterior : public NetworkPosterior {
 public:
  /// Throws ShapeError when the parts don't go together.
  explicit DirectPosterior(NetworkParts parts);

  /// Of every num_networks consecutive samples one comes from each network, in random order.
  Samples draw(Index n, const StreamId& id) const override;
  Vector log_prob(const RowMatrix& theta) const override;

  /// The mixture at x_o in the space of u. Throws Error when the estimator is no mixture.
  const GaussianMixture& mixture() const;

 private:
  struct Member {
    EmbeddedEstimator<float> network;
    Parameters<float> weights;
  };

  const std::optional<GaussianMixture>& proposal() const {
    return std::get<DirectParts>(parts().of_role).proposal;
  }
  GaussianMixture mixture_of(const Member& member) const;
  GaussianMixture mixture_of_networks() const;
  Vector networks_log_prob(const RowMatrixF& u) const;

  std::vector<Member> members_;
  RowMatrixF z_;                            ///< (1, F or k): x_o, transformed
  std::optional<GaussianMixture> mixture_;  ///< of mixtures, already divided by the proposal
};

/// The density network of parts of a single one, in the role of a posterior or of a likelihood.
EmbeddedEstimator<float> make_network(const NetworkParts& parts);

/// The network that a config and a structure seed stand for.
EmbeddedEstimator<float> make_network(const EstimatorConfig& config, Index num_inputs,
                                      const TrainedEmbeddingConfig& embedding, Index dimension,
                                      std::uint64_t structure_seed);

}  // namespace npdr::inference
