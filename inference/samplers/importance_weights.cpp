#include "inference/samplers/importance_weights.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace npdr::inference {
namespace {

bool is_number(double log) { return log < kInfinity; }

}  // namespace

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

double largest_power(double low, double high, const std::function<bool(double)>& is_enough) {
  if (is_enough(high)) return high;
  for (int i = 0; i < 60; ++i) {
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

}  // namespace npdr::inference
