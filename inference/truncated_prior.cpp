#include "inference/truncated_prior.h"

#include <cmath>
#include <string>

#include "core/constants.h"
#include "core/error.h"
#include "core/log_sum_exp.h"
#include "inference/samplers/group_moves.h"
#include "inference/standard_normal.h"

namespace npdr::inference {
namespace {

constexpr double kOutside = 1e-4;         // share of the posterior's mass
constexpr Index kSupportDraws = 15'000;   // that tell where it is
constexpr Index kGroup = 500;             // draws that are made together
constexpr double kEnough = 2.0 * kGroup;  // effective candidates of a group
constexpr Index kMostBatches = 16;        // of kGroup candidates of each kind
constexpr std::uint64_t kRowsOfOne = 64;  // random ones for each draw: an ensemble takes more
constexpr Index kMoves = 50;              // where those weren't enough
constexpr double kWidth = 2.0;            // of the Gaussian, in the posterior's deviations
constexpr double kLeastDeviation = 1e-6;  // of it

// In every direction `kWidth` times as wide as the population.
GaussianMixture wide_gaussian(const WeightedPopulation& of) {
  const Index dimension = of.points().cols();
  return {
      .log_weights = Vector::Zero(1),
      .means = {of.mean()},
      .precision_factors = {precision_factor(kWidth * kWidth * of.covariance() +
                                             kLeastDeviation * kLeastDeviation *
                                                 Eigen::MatrixXd::Identity(dimension, dimension))}};
}

// For draws of which no two are the same.
bool are_enough(const WeightedPopulation& candidates) {
  return candidates.has_weight() && candidates.effective_size() >= kEnough &&
         candidates.weights().sum() >= static_cast<double>(kGroup);
}

}  // namespace

TruncatedPrior::TruncatedPrior(const NetworkPosterior& posterior)
    : posterior_(posterior), near_(posterior.importance_proposal()) {
  const StreamId id{posterior.parts().structure_seed, "truncation", 0, 0, 0};
  const RowMatrix theta = near_.sample(kSupportDraws, id);
  const Vector near = near_.log_prob(theta) - posterior.prior().log_prob(theta);
  around_ = wide_gaussian({posterior.prior().to_normal(theta), log_ratio(theta) - near});
  // The tails of a posterior that is wider than its proposal lie in those of the Gaussian.
  const WeightedPopulation draws = draw_mixture(kSupportDraws / 3, id);
  const Vector ratio = log_ratio(posterior.prior().to_theta(draws.points()));
  threshold_ =
      WeightedPopulation(draws.points(), ratio + draws.log_weights()).quantile(ratio, kOutside);
}

// log p(u | x_o) / p(u) but for a constant, (n); -infinity where there is no such density.
Vector TruncatedPrior::log_ratio(const RowMatrix& theta) const {
  const Vector ratio = posterior_.relative_log_prob(theta) - posterior_.prior().log_prob(theta);
  return ratio.array().isFinite().select(ratio, -kInfinity);
}

std::vector<std::uint32_t> TruncatedPrior::rows_within(const RowMatrix& theta) const {
  const Vector ratio = log_ratio(theta);
  std::vector<std::uint32_t> rows;
  for (Index i = 0; i < ratio.size(); ++i) {
    if (ratio(i) >= threshold_) rows.push_back(static_cast<std::uint32_t>(i));
  }
  return rows;
}

// `values` (n) where u lies within the region, elsewhere -infinity.
Vector TruncatedPrior::inside(const RowMatrix& theta, const Vector& values) const {
  return (log_ratio(theta).array() >= threshold_).select(values, -kInfinity);
}

// n of each of the three, with the logs of p over the sum of their densities.
WeightedPopulation TruncatedPrior::draw_mixture(Index n, const StreamId& id) const {
  const Prior& prior = posterior_.prior();
  RowMatrix u(3 * n, prior.dimension());
  u.topRows(n) = draw_standard_normal(n, prior.dimension(), within(id, "prior"));
  u.middleRows(n, n) = around_.sample(n, within(id, "around"));
  u.bottomRows(n) = prior.to_normal(near_.sample(n, within(id, "posterior")));
  const RowMatrix theta = prior.to_theta(u);
  const Vector near = near_.log_prob(theta) - prior.log_prob(theta);
  const Vector gaussian = around_.log_prob(u) - log_standard_normal(u);
  ColumnMatrixX<double> over_prior(3 * n, 3);
  over_prior << Vector::Zero(3 * n), near, gaussian;
  const Vector log_weights = -log_sum_exp_of_rows(over_prior);
  return {u, log_weights.array().isFinite().select(log_weights, -kInfinity)};
}

// Some of them lie in the region; the weights of the others are 0.
WeightedPopulation TruncatedPrior::draw_candidates(StreamId id) const {
  const Prior& prior = posterior_.prior();
  WeightedPopulation all(prior.dimension());
  id.row *= kRowsOfOne;
  for (Index batch = 0; batch < kMostBatches && !are_enough(all); ++batch, ++id.epoch) {
    const WeightedPopulation more = draw_mixture(kGroup, id);
    all.append({more.points(), inside(prior.to_theta(more.points()), more.log_weights())});
  }
  if (!all.has_weight()) {
    throw Error(
        "truncated proposal: of " + std::to_string(all.size()) +
        " candidates none lies where the posterior of an earlier round is; simulate more in "
        "each round, or take fewer rounds");
  }
  return all;
}

// Steps are in the deviations of the Gaussian around the region, however small that is.
void TruncatedPrior::move(RowMatrix& u, Stream& stream) const {
  const Vector& mean = around_.means.front();
  const Eigen::MatrixXd& factor = around_.precision_factors.front();
  RowMatrix scaled = (u.rowwise() - mean.transpose()) * factor.transpose();
  const auto unscaled = [&](const RowMatrix& at) -> RowMatrix {
    const Eigen::MatrixXd steps = factor.triangularView<Eigen::Upper>().solve(at.transpose());
    return (steps.colwise() + mean).transpose();
  };
  const auto log_density = [&](const RowMatrix& at) -> Vector {
    const RowMatrix there = unscaled(at);
    return inside(posterior_.prior().to_theta(there), log_standard_normal(there));
  };
  move_group(scaled, log_density, kMoves, stream);
  u = unscaled(scaled);
}

// Weighted by p / (3 m), with m their mixture: the mean of p / m inside is the mass.
double TruncatedPrior::prior_mass() const {
  const StreamId id{posterior_.parts().structure_seed, "truncated_mass", 0, 0, 0};
  return 3.0 * draw_candidates(id).log_weights().array().exp().mean();
}

RowMatrix TruncatedPrior::draw_group(const StreamId& id) const {
  const WeightedPopulation candidates = draw_candidates(id);
  Stream stream(within(id, "resampling"));
  RowMatrix u = candidates.resampled(kGroup, stream);
  if (!are_enough(candidates)) move(u, stream);
  return posterior_.prior().to_theta(u);
}

RowMatrix TruncatedPrior::sample(Index n, const StreamId& id) const {
  return draw_in_groups(n, kGroup, posterior_.prior().dimension(), id,
                        [&](const StreamId& group) { return draw_group(group); });
}

}  // namespace npdr::inference
