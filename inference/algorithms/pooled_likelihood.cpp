#include "inference/algorithms/pooled_likelihood.h"

#include "inference/informative_features.h"

namespace npdr::inference {
namespace {

FeatureTransform components_of(const PosteriorEstimationConfig& config, const FeatureSource& x) {
  return varying_outputs(fit_feature_transform(x, kPooledComponents, config.tails), x);
}

FeatureTransform transform_of(const PosteriorEstimationConfig& config, const RoundData& training,
                              const FeatureTransform& of_posterior) {
  if (config.embedding.features > 0) return components_of(config, *training.x);
  const FeatureTransform seen =
      config.principal_components > 0 ? of_posterior : without_copies(of_posterior);
  const FeatureTransform varying = varying_outputs(seen, *training.x);
  if (varying.num_outputs() <= kMostPooledFeatures) return varying;
  if (config.principal_components > 0) return components_of(config, *training.x);
  const std::vector<Index> informative = varying_features(
      informative_features(*training.x, seen, training.prior->to_normal(training.theta)),
      *training.x);
  const bool are_few = !informative.empty() && std::ssize(informative) <= kMostPooledFeatures;
  return are_few ? selected_outputs(seen, informative) : components_of(config, *training.x);
}

// Whether an output is a sum over features, not one of them.
bool has_components(const FeatureTransform& transform) {
  return ((transform.basis.array() != 0.0f).colwise().count() > 1).any();
}

}  // namespace

PooledLikelihood untrained_likelihood(const PosteriorEstimationConfig& config,
                                      const RoundData& training, const NetworkParts& posterior) {
  PooledLikelihood likelihood{.estimator = posterior.estimator,
                              .transform = transform_of(config, training, posterior.transform)};
  EstimatorKind& kind = likelihood.estimator.kind;
  if (has_components(likelihood.transform) && kind == EstimatorKind::nsf) kind = EstimatorKind::maf;
  return likelihood;
}

}  // namespace npdr::inference
