#include "inference/pareto_tail.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/constants.h"

namespace npdr::inference {
namespace {

constexpr Index kFewest = 5;

// The fit whose other parameter is theta: k, the mean of log(1 - theta x), and the scale
// -k / theta, which is the mean of x for an exponential tail.
ParetoTail tail_at(const Eigen::ArrayXd& x, double theta) {
  constexpr double exponential = 1e-9;
  if (std::abs(theta) < exponential) return {0.0, x.mean()};
  const double k = (-theta * x).log1p().mean();
  return {k, -k / theta};
}

}  // namespace

double ParetoTail::probability_beyond(double y) const {
  constexpr double exponential = 1e-6;
  return k > exponential ? std::pow(1.0 + k * y / scale, -1.0 / k) : std::exp(-y / scale);
}

ParetoTail fit_pareto_tail(const Vector& excess) {
  const double largest = excess(excess.size() - 1);
  const Eigen::ArrayXd x = (excess.array() / largest).max(std::numeric_limits<double>::epsilon());
  const auto m = static_cast<double>(x.size());
  const auto count = static_cast<Index>(30.0 + std::floor(std::sqrt(m)));
  const double quartile = x(std::max<Index>(static_cast<Index>(m / 4.0 + 0.5) - 1, 0));
  Vector theta(count), log_likelihood(count);
  for (Index i = 0; i < count; ++i) {
    const double share = static_cast<double>(count) / (static_cast<double>(i) + 0.5);
    theta(i) = 1.0 + (1.0 - std::sqrt(share)) / (3.0 * quartile);
    const ParetoTail tail = tail_at(x, theta(i));
    log_likelihood(i) = m * (-std::log(tail.scale) - tail.k - 1.0);
  }
  const Eigen::ArrayXd weights = (log_likelihood.array() - log_likelihood.maxCoeff()).exp();
  const ParetoTail tail = tail_at(x, (weights * theta.array()).sum() / weights.sum());
  return {(m * tail.k + 5.0) / (m + 10.0), tail.scale * largest};
}

double pareto_k(const Vector& weights) {
  const auto n = static_cast<double>(weights.size());
  const auto tail = static_cast<Index>(std::ceil(std::min(0.2 * n, 3.0 * std::sqrt(n))));
  if (tail < kFewest || tail >= weights.size()) return kInfinity;
  std::vector<double> sorted(weights.begin(), weights.end());
  std::ranges::sort(sorted);
  const double threshold = sorted[sorted.size() - static_cast<std::size_t>(tail) - 1];
  if (!(sorted.back() > 0.0)) return kInfinity;
  const Vector excess =
      Eigen::Map<const Vector>(sorted.data(), std::ssize(sorted)).tail(tail).array() - threshold;
  constexpr double rounding = 4.0 * std::numeric_limits<double>::epsilon();
  if (excess(tail - 1) <= rounding * sorted.back()) return -kInfinity;  // they all weigh the same
  const double k = fit_pareto_tail(excess).k;
  return std::isfinite(k) ? k : kInfinity;
}

}  // namespace npdr::inference
