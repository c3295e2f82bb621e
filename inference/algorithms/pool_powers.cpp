#include "inference/algorithms/pool_powers.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "inference/estimators/gaussian_mixture.h"
#include "inference/pooled_posterior.h"

namespace npdr::inference {
namespace {

constexpr Index kMostRows = 300;
constexpr Index kRowsForOne = 20;  // simulations for each judging one
constexpr Index kDraws = 1000;     // of q, for each row
constexpr int kSteps = 40;         // of a and b
constexpr double kStep = PoolPowers::kLargestSum / kSteps;

// What the networks say of the parameters that x was simulated with, and of draws of q given x.
PoolEvidence evidence_given(NetworkParts parts, const VectorF& x, const RowMatrix& theta,
                            const StreamId& id) {
  parts.x_o = x;
  const PooledPosterior pool(std::move(parts));
  RowMatrix points(kDraws + 1, theta.cols());
  points.row(0) = theta;
  points.bottomRows(kDraws) = pool.proposal().sample(kDraws, id);
  return pool.evidence(points);
}

double log_prior(PoolPowers powers) {
  const double sum = (powers.posterior + powers.likelihood - 1.0) / 0.3;
  const double difference = powers.posterior - powers.likelihood;
  return -0.5 * (sum * sum + difference * difference);
}

double score(const std::vector<PoolEvidence>& rows, PoolPowers powers) {
  double sum = log_prior(powers);
  for (const PoolEvidence& evidence : rows) {
    const Vector w = evidence.log_weights(powers);
    sum += w(0) - log_sum_exp(w) + std::log(static_cast<double>(w.size()));
  }
  return sum;
}

PoolPowers best_powers(const std::vector<PoolEvidence>& rows) {
  std::vector<std::pair<double, PoolPowers>> best(kSteps + 1, {-HUGE_VAL, {}});
  parallel_for(kSteps + 1, [&](Index i) {
    for (Index j = 0; i + j <= kSteps; ++j) {
      const PoolPowers powers{kStep * static_cast<double>(i), kStep * static_cast<double>(j)};
      const double s = score(rows, powers);
      auto& [most, of] = best[static_cast<std::size_t>(i)];
      if (s > most) std::tie(most, of) = std::pair(s, powers);
    }
  });
  return std::ranges::max_element(best, {}, &std::pair<double, PoolPowers>::first)->second;
}

}  // namespace

Index num_judging_rows(Index num_rows) { return std::min(num_rows / kRowsForOne, kMostRows); }

PoolPowers pool_powers(const NetworkParts& parts, const RoundData& data, const StreamId& id) {
  const Index count = num_judging_rows(data.theta.rows()), first = data.theta.rows() - count;
  if (count == 0) return best_powers({});
  std::vector<std::uint32_t> rows(static_cast<std::size_t>(count));
  std::iota(rows.begin(), rows.end(), static_cast<std::uint32_t>(first));
  RowMatrixF x;
  data.x->gather(rows, 0, x);
  std::vector<PoolEvidence> evidence(rows.size());
  parallel_for(count, [&](Index i) {
    StreamId draws = named(id, "pool_score");
    draws.row = static_cast<std::uint64_t>(i * kDraws);
    evidence[static_cast<std::size_t>(i)] =
        evidence_given(parts, x.row(i).transpose(), data.theta.row(first + i), draws);
  });
  // Without a density of q at the parameters there is nothing to take a power of.
  std::erase_if(evidence, [](const PoolEvidence& row) { return !std::isfinite(row.posterior(0)); });
  return best_powers(evidence);
}

}  // namespace npdr::inference
