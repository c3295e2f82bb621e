/// Posteriors that a trained network gives, in one of three roles.
#pragma once

#include <memory>
#include <optional>
#include <variant>

#include "core/enum_names.h"
#include "inference/estimators/estimator_config.h"
#include "inference/estimators/gaussian_mixture.h"
#include "inference/estimators/parameters.h"
#include "inference/estimators/trained_embedding.h"
#include "inference/feature_transform.h"
#include "inference/posterior.h"
#include "inference/sampler_config.h"

namespace npdr::inference {

/// Role of the network between u (the parameters where the prior is N(0, I)) and z (the transformed
/// x).
enum class NetworkRole {
  posterior,   ///< log q(u | z): the NPE family
  likelihood,  ///< log q(z | u): NLE
  ratio,       ///< log p(z | u) / p(z): the NRE family
};
constexpr auto enum_table(NetworkRole) {
  using enum NetworkRole;
  return std::to_array<EnumRow<NetworkRole>>(
      {{posterior, "posterior"}, {likelihood, "likelihood"}, {ratio, "ratio"}});
}

/// Powers a of q(u | z) / p(u) and b of l(z | u) in a pool (pooled_posterior.h): q alone.
struct PoolPowers {
  double posterior = 1.0;   ///< a
  double likelihood = 0.0;  ///< b

  static constexpr double kLargestSum = 2.0;
  bool operator==(const PoolPowers&) const = default;
};

/// Likelihood networks that are pooled with a posterior's (pooled_posterior.h): as many, of what
/// `transform` makes of x.
struct PooledLikelihood {
  EstimatorConfig estimator;
  FeatureTransform transform;
  Parameters<float> parameters = {};
  PoolPowers powers = {};
};

/// Parts of a network in the role of a posterior.
struct DirectParts {
  TrainedEmbeddingConfig embedding = {};
  /// Proposal of the simulations that a mixture saw, which it must still be divided by (NPE-A).
  std::optional<GaussianMixture> proposal = {};
  std::optional<PooledLikelihood> likelihood = {};
};

/// Parts of a network in the role of a likelihood or of a ratio.
struct SurrogateParts {
  bool is_ratio = false;
  SamplerConfig sampler = {};
};

using RoleParts = std::variant<DirectParts, SurrogateParts>;
/// The usual parts of a role.
RoleParts role_parts(NetworkRole role);

/// Everything that such a posterior consists of: what a file must hold.
struct NetworkParts {
  Prior prior;
  RoleParts of_role = DirectParts{};
  EstimatorConfig estimator;
  std::uint64_t structure_seed = 0;
  FeatureTransform transform;
  Parameters<float> parameters;
  VectorF x_o;  ///< (F), not transformed

  NetworkRole role() const;
  /// Null unless the role is that of a posterior, which is pooled.
  const PooledLikelihood* pooled_likelihood() const;
};

class NetworkPosterior : public Posterior {
 public:
  const Prior& prior() const override { return parts_.prior; }
  const NetworkParts& parts() const { return parts_; }

  /// A density near this posterior that is normalized and cheap to draw from: q of a
  /// pool, and itself in the role of a posterior.
  virtual const Posterior& importance_proposal() const { return *this; }

  /// The posterior given another observation (F).
  std::unique_ptr<NetworkPosterior> given(const VectorF& x) const;

 protected:
  explicit NetworkPosterior(NetworkParts parts) : parts_(std::move(parts)) {}

 private:
  NetworkParts parts_;
};

/// The layers of the parts' network, and their places in `parameters`, which aren't looked at.
/// Throws InputError for sizes that can't be.
ParameterLayout network_layout(const NetworkParts& parts);

/// The posterior of the parts' role. Throws ShapeError when they don't go together.
std::unique_ptr<NetworkPosterior> make_posterior(NetworkParts parts);

}  // namespace npdr::inference
