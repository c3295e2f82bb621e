#include "inference/algorithms/npe_nle.h"

#include <algorithm>

#include "inference/algorithms/pool_powers.h"
#include "inference/informative_features.h"
#include "inference/truncated_prior.h"

namespace npdr::inference {
namespace {

Index num_of_last_round(const std::vector<std::uint32_t>& rows, const RoundData& data) {
  const auto last = static_cast<std::uint32_t>(data.posteriors.size() + 1);
  return std::ranges::count_if(rows, [&](std::uint32_t row) { return data.round[row] == last; });
}

// Takes those that judge from the rows that are learned from: the last of the last round.
void take_judging_rows(LearnedRows& learned, Index num_new) {
  const Index count = std::min(num_judging_rows(std::ssize(learned.rows)), num_new);
  learned.judging.assign(learned.rows.end() - count, learned.rows.end());
  learned.rows.resize(learned.rows.size() - learned.judging.size());
  std::erase_if(learned.likelihood_rows, [&](std::uint32_t row) {
    return std::ranges::binary_search(learned.judging, row);
  });
}

// Rows in the last of the regions R_2, ..., R_r. Round j has drawn N_j rows of the prior within
// R_j, whose share of the prior is Z_j, so that at u there are
//   N_1 + sum_j 1[u in R_j] N_j / Z_j
// of them for each of the prior's; of N_r rows that judge don't count. w is one over that, with a
// mean of 1. Where regions lie within each other all are the same.
LearnedRows rows_of_last_region(const RoundData& data, bool are_pooled) {
  const std::vector<Index> drawn = num_drawn(data);
  Vector density = Vector::Constant(data.theta.rows(), static_cast<double>(drawn.front()));
  LearnedRows learned{.likelihood_rows = all_rows(data)};
  for (std::size_t j = 1; j <= data.posteriors.size(); ++j) {
    const TruncatedPrior region(*data.posteriors[j - 1]);
    const std::vector<std::uint32_t> within = region.rows_within(data.theta);
    auto count = static_cast<double>(drawn[j]);
    if (j == data.posteriors.size()) {
      const Index num_new = num_of_last_round(within, data);
      learned.rows = within;
      if (are_pooled) take_judging_rows(learned, num_new);
      const Index num_learned = num_new - std::ssize(learned.judging);
      if (num_new > 0) count *= static_cast<double>(num_learned) / static_cast<double>(num_new);
    }
    density(within).array() += count / region.prior_mass();
  }
  const Vector weights = density.cwiseInverse();
  const double mean = learned.rows.empty() ? 1.0 : weights(learned.rows).mean();
  learned.weights = (weights / mean).cast<float>();
  return learned;
}

// The simulations that train networks which are pooled.
RoundData without_judging_rows(RoundData data) {
  const Index rows = data.theta.rows() - num_judging_rows(data.theta.rows());
  data.theta.conservativeResize(rows, Eigen::NoChange);
  data.round.resize(static_cast<std::size_t>(rows));
  return data;
}

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

LearnedRows rows_of_npe_nle(const RoundData& data, bool are_pooled) {
  if (!data.posteriors.empty()) return rows_of_last_region(data, are_pooled);
  LearnedRows learned{.rows = all_rows(data), .likelihood_rows = all_rows(data)};
  if (are_pooled) take_judging_rows(learned, std::ssize(learned.rows));
  return learned;
}

PooledLikelihood untrained_likelihood(const PosteriorEstimationConfig& config,
                                      const RoundData& data, const NetworkParts& posterior) {
  if (!data.posteriors.empty()) return *data.posteriors.back()->parts().pooled_likelihood();
  const RoundData training = without_judging_rows(data);
  PooledLikelihood likelihood{.estimator = posterior.estimator,
                              .transform = transform_of(config, training, posterior.transform)};
  EstimatorKind& kind = likelihood.estimator.kind;
  if (has_components(likelihood.transform) && kind == EstimatorKind::nsf) kind = EstimatorKind::maf;
  return likelihood;
}

RowMatrix propose_for_npe_nle(const NetworkPosterior& posterior, Index n, const StreamId& id) {
  return TruncatedPrior(posterior).sample(n, id);
}

}  // namespace npdr::inference
