#include "inference/algorithms/pool_powers.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/constants.h"
#include "core/log_sum_exp.h"
#include "core/parallel.h"
#include "inference/pooled_posterior.h"
#include "inference/truncated_prior.h"

namespace npdr::inference {
namespace {

constexpr Index kMostRows = 300;
constexpr Index kRowsForOne = 20;           // simulations for each judging one
constexpr Index kDraws = 1000;              // of q, for each row
constexpr Index kRowsOfOne = 64 * kDraws;   // random ones: an ensemble takes more
constexpr Index kSteps = 40;                // of a and b, and of their sum
constexpr Index kUnsharpened = kSteps / 2;  // of the sum 1
constexpr double kOneDeviation = 0.5;       // [nats] by which it lowers a Gaussian's log density
constexpr double kStep = PoolPowers::kLargestSum / static_cast<double>(kSteps);

// Log densities of the networks at the parameters that x was simulated with, and at draws of q.
// Where rows come from a region alone, which q has learned and the likelihood can't, draws beyond
// it don't count.
PoolEvidence evidence_given(NetworkParts parts, const VectorF& x, const RowMatrix& theta,
                            const TruncatedPrior* region, const StreamId& id) {
  parts.x_o = x;
  const PooledPosterior pool(std::move(parts));
  RowMatrix points(kDraws + 1, theta.cols());
  points.row(0) = theta;
  points.bottomRows(kDraws) = pool.importance_proposal().sample(kDraws, id);
  PoolEvidence evidence = pool.evidence(points);
  if (region == nullptr) return evidence;
  const Vector all = evidence.posterior;
  const std::vector<std::uint32_t> within = region->rows_within(points);
  evidence.posterior.tail(kDraws).setConstant(-kInfinity);
  evidence.posterior(within) = all(within);
  return evidence;
}

double log_prior(PoolPowers powers) {
  const double sum = (powers.posterior + powers.likelihood - 1.0) / 0.3;
  const double difference = (powers.posterior - powers.likelihood) / 0.3;
  return -0.5 * (sum * sum + difference * difference);
}

double score_of(const std::vector<PoolEvidence>& rows, PoolPowers powers) {
  double sum = log_prior(powers);
  for (const PoolEvidence& evidence : rows) {
    const Vector w = evidence.log_weights(powers);
    sum += w(0) - log_sum_exp(w) + std::log(static_cast<double>(w.size()));
  }
  return sum;
}

struct Scored {
  PoolPowers powers;
  double score = -kInfinity;
};

// The best powers of each sum.
std::vector<Scored> best_of_sums(const std::vector<PoolEvidence>& rows) {
  std::vector<Scored> best(kSteps + 1);
  parallel_for(kSteps + 1, [&](Index sum) {
    Scored& most = best[static_cast<std::size_t>(sum)];
    for (Index i = 0; i <= sum; ++i) {
      const PoolPowers powers{kStep * static_cast<double>(i), kStep * static_cast<double>(sum - i)};
      const double score = score_of(rows, powers);
      if (score > most.score) most = {powers, score};
    }
  });
  return best;
}

PoolPowers best_powers(const std::vector<PoolEvidence>& rows) {
  const std::vector<Scored> sums = best_of_sums(rows);
  const auto best = std::ranges::max_element(sums, {}, &Scored::score);
  const auto least =
      std::find_if(std::min(sums.begin() + kUnsharpened, best), best,
                   [&](const Scored& sum) { return sum.score >= best->score - kOneDeviation; });
  return least->powers;
}

}  // namespace

Index num_judging_rows(Index num_rows) { return std::min(num_rows / kRowsForOne, kMostRows); }

PoolPowers pool_powers(const NetworkParts& parts, const RoundData& data,
                       const std::vector<std::uint32_t>& rows, const StreamId& id) {
  if (rows.empty()) return best_powers({});
  RowMatrixF x;
  data.x->gather(rows, 0, x);
  std::optional<TruncatedPrior> region;
  if (!data.posteriors.empty()) region.emplace(*data.posteriors.back());
  std::vector<PoolEvidence> evidence(rows.size());
  parallel_for(std::ssize(rows), [&](Index i) {
    StreamId draws = named(id, "pool_score");
    draws.row = static_cast<std::uint64_t>(i * kRowsOfOne);
    const auto place = static_cast<std::size_t>(i);
    evidence[place] = evidence_given(parts, x.row(i).transpose(), data.theta.row(rows[place]),
                                     region ? &*region : nullptr, draws);
  });
  // Without a density of q at the parameters there is nothing to take a power of.
  std::erase_if(evidence, [](const PoolEvidence& row) { return !std::isfinite(row.posterior(0)); });
  return best_powers(evidence);
}

}  // namespace npdr::inference
