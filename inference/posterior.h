/// A posterior p(theta | x_o), whatever method made it.
#pragma once

#include <memory>

#include "core/random.h"
#include "core/types.h"
#include "inference/estimators/embedded_estimator.h"
#include "inference/estimators/gaussian_mixture.h"
#include "inference/feature_transform.h"
#include "inference/prior.h"

namespace npdr::inference {

/// Const calls are thread-safe.
class Posterior {
 public:
  virtual ~Posterior() = default;
  virtual const Prior& prior() const = 0;

  /// (n, D) samples of theta, all inside of the prior's support. Sample i depends on `id` and i
  /// alone: not on n, nor on the number of threads.
  virtual RowMatrix sample(Index n, const StreamId& id) const = 0;

  /// log p(theta | x_o) in nats, (n); -infinity outside of the prior's support.
  virtual Vector log_prob(const RowMatrix& theta) const = 0;

  /// The theta (D) with the largest posterior density: the best of 1000 samples, refined by NLopt
  /// (Rowan 1990, subplex) in the space where the prior is N(0, I).
  Vector map(const StreamId& id) const;
};

/// What a direct posterior consists of: everything that a file must hold.
struct DirectPosteriorParts {
  Prior prior;
  EstimatorConfig estimator;
  Index trained_features = 0;  ///< width of the linear layer, 0: none
  std::uint64_t structure_seed = 0;
  FeatureTransform transform;
  Parameters<float> parameters;
  VectorF x_o;  ///< (F), not transformed
};

/// A posterior that a density estimator gives directly (the NPE family):
///   log p(theta | x_o) = log q(u(theta) | x_o) + log |du / dtheta|.
class DirectPosterior : public Posterior {
 public:
  /// Throws ShapeError when the parts don't go together.
  explicit DirectPosterior(DirectPosteriorParts parts);

  const Prior& prior() const override { return parts_.prior; }
  RowMatrix sample(Index n, const StreamId& id) const override;
  Vector log_prob(const RowMatrix& theta) const override;

  const DirectPosteriorParts& parts() const { return parts_; }

  /// The posterior given another observation (F).
  DirectPosterior given(const VectorF& x) const;

  /// The mixture at x_o in the space of u. Throws Error when the estimator is no mixture.
  GaussianMixture mixture() const;

 private:
  DirectPosteriorParts parts_;
  std::shared_ptr<const EmbeddedEstimator<float>> network_;
  RowMatrixF x_;  ///< (1, F or k), transformed
};

/// The network that a config and a structure seed stand for.
EmbeddedEstimator<float> make_network(const EstimatorConfig& config, Index num_inputs,
                                      Index trained_features, Index dimension,
                                      std::uint64_t structure_seed);

}  // namespace npdr::inference
