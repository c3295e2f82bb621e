#include "analysis/density_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "core/quantile.h"

namespace npdr::analysis {
namespace {

double silverman_bandwidth(const std::vector<double>& sorted) {
  const auto n = static_cast<double>(sorted.size());
  double mean = 0.0, squares = 0.0;
  for (const double v : sorted) mean += v / n;
  for (const double v : sorted) squares += (v - mean) * (v - mean);
  const double std = sorted.size() > 1 ? std::sqrt(squares / (n - 1.0)) : 0.0;
  const double iqr = quantile_of_sorted(sorted, 0.75) - quantile_of_sorted(sorted, 0.25);
  return 0.9 * std::min(std, iqr / 1.34) * std::pow(n, -0.2);
}

// Numbers of samples at each of the points lower + k * spacing, fractions by distance.
Vector linear_counts(const std::vector<double>& samples, double lower, double spacing,
                     Index num_points) {
  Vector counts = Vector::Zero(num_points);
  for (const double v : samples) {
    const double position = (v - lower) / spacing;
    if (!(position >= 0.0 && position <= static_cast<double>(num_points - 1))) continue;
    const Index k = std::min(static_cast<Index>(position), num_points - 2);
    const double share = position - static_cast<double>(k);
    counts(k) += 1.0 - share;
    counts(k + 1) += share;
  }
  return counts;
}

// Point k of a line of n that is reflected at its first and last point, without end.
Index reflect(Index k, Index n) {
  const Index period = 2 * (n - 1);
  const Index m = ((k % period) + period) % period;
  return m < n ? m : period - m;
}

}  // namespace

RowMatrix density_curve(const Eigen::Ref<const Vector>& samples, double lower, double upper,
                        Index num_points) {
  if (!std::isfinite(upper - lower) || lower >= upper || num_points < 2) {
    throw InputError(
        fmt::format("density over [{}, {}] at {} points, needs finite ascending ends "
                    "and at least 2 points",
                    lower, upper, num_points));
  }
  const double spacing = (upper - lower) / static_cast<double>(num_points - 1);
  RowMatrix curve(num_points, 2);
  for (Index k = 0; k < num_points; ++k) curve(k, 0) = lower + static_cast<double>(k) * spacing;
  curve.col(1).setZero();
  const std::vector<double> sorted = sorted_finite(samples);
  if (sorted.empty()) return curve;

  // Wider ones, of samples far beyond both ends, would be as flat, and take no end.
  const double bandwidth = std::clamp(silverman_bandwidth(sorted), spacing, 2.0 * (upper - lower));
  const Vector counts = linear_counts(sorted, lower, spacing, num_points);
  const double peak =
      1.0 / (bandwidth * std::sqrt(2.0 * std::numbers::pi) * static_cast<double>(sorted.size()));
  const auto reach = static_cast<Index>(std::ceil(5.0 * bandwidth / spacing));
  for (Index step = -reach; step <= reach; ++step) {
    const double u = static_cast<double>(step) * spacing / bandwidth;
    const double weight = peak * std::exp(-0.5 * u * u);
    for (Index k = 0; k < num_points; ++k) {
      // A mass on an end point is its own mirror image, of which the inside holds one half.
      const Index source = reflect(k + step, num_points);
      const bool at_end = source == 0 || source == num_points - 1;
      curve(k, 1) += weight * counts(source) * (at_end ? 2.0 : 1.0);
    }
  }
  return curve;
}

}  // namespace npdr::analysis
