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
constexpr Index kRowsForOne = 20;           // simulations for each judging one
constexpr Index kDraws = 1000;              // of q, for each row
constexpr Index kSteps = 40;                // of a and b, and of their sum
constexpr Index kUnsharpened = kSteps / 2;  // of the sum 1
constexpr double kStep = PoolPowers::kLargestSum / static_cast<double>(kSteps);

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

// What each row says of the powers, and of all of them the sum with the prior.
struct Score {
  PoolPowers powers;
  Vector of_rows;
  double sum = -HUGE_VAL;
};

Score score_of(const std::vector<PoolEvidence>& rows, PoolPowers powers) {
  Score score{powers, Vector(std::ssize(rows)), log_prior(powers)};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Vector w = rows[i].log_weights(powers);
    score.of_rows(static_cast<Index>(i)) =
        w(0) - log_sum_exp(w) + std::log(static_cast<double>(w.size()));
  }
  score.sum += score.of_rows.sum();
  return score;
}

// The best powers of each sum.
std::vector<Score> best_of_sums(const std::vector<PoolEvidence>& rows) {
  std::vector<Score> best(kSteps + 1);
  parallel_for(kSteps + 1, [&](Index sum) {
    for (Index i = 0; i <= sum; ++i) {
      Score score = score_of(rows, {kStep * static_cast<double>(i),  //
                                    kStep * static_cast<double>(sum - i)});
      Score& most = best[static_cast<std::size_t>(sum)];
      if (score.sum > most.sum) most = std::move(score);
    }
  });
  return best;
}

// Whether rows hardly tell that `better` is: by less than a standard error of their differences.
bool is_as_good(const Score& score, const Score& better) {
  const Eigen::ArrayXd gains = better.of_rows - score.of_rows;
  const double n = static_cast<double>(gains.size());
  const double error =
      std::sqrt((gains - gains.mean()).square().sum() * n / std::max(1.0, n - 1.0));
  return better.sum - score.sum <= error;
}

PoolPowers best_powers(const std::vector<PoolEvidence>& rows) {
  const std::vector<Score> scores = best_of_sums(rows);
  const auto best = std::ranges::max_element(scores, {}, &Score::sum);
  const auto least = std::find_if(std::min(scores.begin() + kUnsharpened, best), best,
                                  [&](const Score& score) { return is_as_good(score, *best); });
  return least->powers;
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
