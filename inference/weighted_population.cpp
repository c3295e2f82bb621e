#include "inference/weighted_population.h"

#include <cmath>
#include <numeric>

#include "core/constants.h"
#include "core/error.h"
#include "core/log_sum_exp.h"

namespace npdr::inference {
namespace {

bool is_number(double log) { return log < kInfinity; }

}  // namespace

double effective_size(const Vector& weights) {
  const double sum = weights.sum();
  return sum * sum / weights.squaredNorm();
}

Vector weighted_mean(const RowMatrix& x, const Vector& weights) {
  return x.transpose() * weights / weights.sum();
}

Eigen::MatrixXd weighted_covariance(const RowMatrix& x, const Vector& weights) {
  const RowMatrix centered = x.rowwise() - weighted_mean(x, weights).transpose();
  const double sum = weights.sum();
  return centered.transpose() * weights.asDiagonal() * centered /
         (sum - weights.squaredNorm() / sum);
}

Eigen::MatrixXd regularized_covariance(const RowMatrix& x, const Vector& weights) {
  Eigen::MatrixXd covariance = weighted_covariance(x, weights);
  covariance.diagonal().array() += 1e-12 + 1e-9 * covariance.diagonal().array();
  return covariance;
}

double largest_number(const Vector& logs) {
  double largest = -kInfinity;
  for (const double value : logs) {
    if (is_number(value)) largest = std::max(largest, value);
  }
  return largest;
}

Vector numbers(const Vector& logs) {
  return logs.unaryExpr([](double log) { return is_number(log) ? log : -kInfinity; });
}

Vector exponentials(const Vector& logs) {
  const double largest = largest_number(logs);
  Vector result = Vector::Zero(logs.size());
  for (Index i = 0; i < logs.size() && largest > -kInfinity; ++i) {
    if (is_number(logs(i))) result(i) = std::exp(logs(i) - largest);
  }
  return result;
}

Vector truncated(const Vector& logs) {
  const Vector weights = exponentials(logs);
  return weights.cwiseMin(weights.sum() / std::sqrt(static_cast<double>(logs.size())));
}

double largest_power(double low, double high, const std::function<bool(double)>& is_enough,
                     int halvings) {
  if (is_enough(high)) return high;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (is_enough(middle) ? low : high) = middle;
  }
  return low;
}

Choice choose_rows(const Vector& weights, Index most, const StreamId& id) {
  const double surplus = static_cast<double>(weights.size()) / static_cast<double>(most);
  double low = 0.0, high = weights.maxCoeff() * std::max(1.0, surplus);
  for (int i = 0; i < 60; ++i) {
    const double c = 0.5 * (low + high);
    const double kept = (weights.array() / c).min(1.0).sum();
    (kept > static_cast<double>(most) ? low : high) = c;
  }
  Choice choice;
  std::vector<double> kept;
  for (Index i = 0; i < weights.size(); ++i) {
    StreamId row = id;
    row.row = static_cast<std::uint64_t>(i);
    const double share = weights(i) / high;
    if (!(share > 0.0) || (share < 1.0 && Stream(row).uniform() >= share)) continue;
    choice.rows.push_back(i);
    kept.push_back(std::max(1.0, share));
  }
  choice.weights = Eigen::Map<const Vector>(kept.data(), std::ssize(kept));
  return choice;
}

double heavy_share(const Vector& weights, const Vector& log_ratios, double most) {
  double sum = 0.0;
  for (Index i = 0; i < weights.size(); ++i) {
    if (weights(i) > 0.0) sum += weights(i) * std::max(0.0, -std::expm1(most - log_ratios(i)));
  }
  return sum / weights.sum();
}

Evidence evidence(const Vector& logs) {
  const auto n = static_cast<double>(logs.size());
  const Vector weights = exponentials(logs);
  const double mean = weights.mean();
  const double variance = (weights.array() - mean).square().sum() / (n - 1.0) / n;
  return {largest_number(logs) + std::log(mean), std::sqrt(variance) / mean};
}

Resampler::Resampler(const Vector& weights)
    : cumulative_(weights.size()), effective_size_(inference::effective_size(weights)) {
  if (!weights.allFinite() || !(weights.minCoeff() >= 0.0) || !(weights.sum() > 0.0)) {
    throw Error("resampling: weights must be finite, >= 0, and not all of them 0");
  }
  std::partial_sum(weights.begin(), weights.end(), cumulative_.begin());
  cumulative_ /= cumulative_(cumulative_.size() - 1);
}

Index Resampler::draw(double uniform) const {
  const auto found = std::lower_bound(cumulative_.begin(), cumulative_.end(), uniform);
  return std::min<Index>(found - cumulative_.begin(), cumulative_.size() - 1);
}

std::vector<Index> Resampler::systematic(Index count, double uniform) const {
  std::vector<Index> rows;
  for (Index i = 0; i < count; ++i) {
    rows.push_back(draw((static_cast<double>(i) + uniform) / static_cast<double>(count)));
  }
  return rows;
}

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
