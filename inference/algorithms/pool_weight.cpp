#include "inference/algorithms/pool_weight.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "inference/ensemble.h"
#include "inference/estimators/gaussian_mixture.h"

namespace npdr::inference {
namespace {

constexpr Index kMostRows = 500;  // of all networks
constexpr Index kDraws = 200;     // of q, for each row

// A row and the network that it validated.
struct HeldOut {
  Index network;
  std::uint32_t row;
};

std::vector<HeldOut> held_out_rows(const RoundData& data, const TrainingConfig& training,
                                   Index num_networks, std::uint64_t seed) {
  std::vector<HeldOut> result;
  const auto most = static_cast<std::size_t>(std::max<Index>(kMostRows / num_networks, 2));
  for (Index m = 0; m < num_networks; ++m) {
    auto rows = validation_rows(data.theta.rows(), training, {seed, m});
    rows.resize(std::min(rows.size(), most));
    for (const std::uint32_t row : rows) result.push_back({m, row});
  }
  return result;
}

// r_i0, ..., r_iK of the row's parameters and of draws of q.
Vector log_ratios(NetworkParts posterior, NetworkParts likelihood, const VectorF& x,
                  const Vector& theta, StreamId id) {
  posterior.x_o = x;
  likelihood.x_o = x;
  const auto q = make_posterior(std::move(posterior)), l = make_posterior(std::move(likelihood));
  RowMatrix points(kDraws + 1, theta.size());
  points.row(0) = theta.transpose();
  points.bottomRows(kDraws) = q->sample(kDraws, id);
  const Vector ratios = l->relative_log_prob(points) - q->log_prob(points);
  // What isn't finite comes from a network far from what it knows: it says 0.
  return ratios.array().isFinite().select(ratios, -1e30);
}

double score(const std::vector<Vector>& ratios, double weight) {
  double sum = 0.0;
  for (const Vector& r : ratios) {
    const double mean = std::log(static_cast<double>(r.size()));
    sum += weight * r(0) - (log_sum_exp(weight * r) - mean);
  }
  return sum / static_cast<double>(ratios.size());
}

}  // namespace

double pool_weight(const NetworkParts& posterior, const NetworkParts& likelihood,
                   const RoundData& data, const TrainingConfig& training, const StreamId& id) {
  constexpr int steps = 20;
  const auto rows = held_out_rows(data, training, posterior.estimator.num_networks, id.seed);
  std::vector<std::uint32_t> of_data;
  for (const HeldOut& each : rows) of_data.push_back(each.row);
  RowMatrixF x;
  data.x->gather(of_data, 0, x);
  std::vector<Vector> ratios(rows.size());
  parallel_for(std::ssize(rows), [&](Index i) {
    const auto [m, row] = rows[static_cast<std::size_t>(i)];
    StreamId draws = named(id, "pool_score");
    draws.row = static_cast<std::uint64_t>(i * kDraws);
    ratios[static_cast<std::size_t>(i)] =
        log_ratios(network_of(posterior, m), network_of(likelihood, m), x.row(i).transpose(),
                   data.theta.row(static_cast<Index>(row)).transpose(), draws);
  });
  double best = 0.0, best_score = 0.0;
  for (int k = 1; k <= steps; ++k) {
    const double weight = static_cast<double>(k) / steps, s = score(ratios, weight);
    if (s > best_score) std::tie(best, best_score) = std::pair(weight, s);
  }
  return best;
}

}  // namespace npdr::inference
