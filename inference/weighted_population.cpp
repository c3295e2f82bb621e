#include "inference/weighted_population.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/constants.h"
#include "core/log_sum_exp.h"
#include "inference/samplers/resampler.h"
#include "inference/weighted_moments.h"

namespace npdr::inference {

WeightedPopulation::WeightedPopulation(RowMatrix points, Vector log_weights)
    : points_(std::move(points)),
      log_weights_(log_weights.array().isNaN().select(-kInfinity, log_weights)) {}

void WeightedPopulation::append(const WeightedPopulation& more) {
  points_.conservativeResize(size() + more.size(), Eigen::NoChange);
  points_.bottomRows(more.size()) = more.points_;
  log_weights_.conservativeResize(points_.rows());
  log_weights_.tail(more.size()) = more.log_weights_;
}

bool WeightedPopulation::has_weight() const {
  return size() > 0 && std::isfinite(log_weights_.maxCoeff());
}

Vector WeightedPopulation::weights() const {
  return (log_weights_.array() - log_weights_.maxCoeff()).exp();
}

double WeightedPopulation::effective_size() const { return inference::effective_size(weights()); }

double WeightedPopulation::log_mean_weight() const { return log_mean_exp(log_weights_); }

Vector WeightedPopulation::mean() const { return weighted_mean(points_, weights()); }

Eigen::MatrixXd WeightedPopulation::covariance() const {
  return weighted_covariance(points_, weights());
}

double WeightedPopulation::quantile(const Vector& values, double below) const {
  std::vector<Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::sort(order, {}, [&](Index i) { return values(i); });
  return values(order[static_cast<std::size_t>(Resampler(weights()(order)).draw(below))]);
}

RowMatrix WeightedPopulation::resampled(Index count, Stream& stream) const {
  const std::vector<Index> rows = Resampler(weights()).systematic(count, stream.uniform());
  RowMatrix result(count, points_.cols());
  Index place = 0;
  for (const std::uint32_t i : stream.permutation(static_cast<std::uint32_t>(count))) {
    result.row(place++) = points_.row(rows[i]);
  }
  return result;
}

RowMatrix WeightedPopulation::draw(Index n, StreamId id) const {
  const Resampler resampler(weights());
  RowMatrix result(n, points_.cols());
  for (Index i = 0; i < n; ++i, ++id.row) {
    result.row(i) = points_.row(resampler.draw(Stream(id).uniform()));
  }
  return result;
}

}  // namespace npdr::inference
