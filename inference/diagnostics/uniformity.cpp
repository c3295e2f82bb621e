#include "inference/diagnostics/uniformity.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <unsupported/Eigen/SpecialFunctions>

#include "core/error.h"

namespace npdr::inference {
namespace {

void require_unit_interval(const Vector& values) {
  if (values.size() < 1) throw InputError("test of uniformity: no values");
  for (Index i = 0; i < values.size(); ++i) {
    if (values(i) >= 0.0 && values(i) <= 1.0) continue;
    throw InputError("test of uniformity: value " + std::to_string(i) + " = " +
                     std::to_string(values(i)) + ", must be between 0 and 1");
  }
}

// P(K >= lambda) of Kolmogorov's distribution.
double kolmogorov_tail(double lambda) {
  if (lambda < 0.2) return 1.0;  // to 1e-12; the series converges slowly there
  double sum = 0.0;
  for (int k = 1; k <= 100; ++k) {
    const double term = std::exp(-2.0 * k * k * lambda * lambda);
    sum += k % 2 == 1 ? term : -term;
    if (term < 1e-18) break;
  }
  return std::clamp(2.0 * sum, 0.0, 1.0);
}

}  // namespace

double kolmogorov_smirnov_p_value(double statistic, Index n) {
  const double root = std::sqrt(static_cast<double>(n));
  return kolmogorov_tail((root + 0.12 + 0.11 / root) * statistic);
}

double anderson_darling(const Vector& values) {
  Vector f = values;
  std::sort(f.begin(), f.end());
  const Index n = f.size();
  double sum = 0.0;
  for (Index i = 0; i < n; ++i) {
    sum += static_cast<double>(2 * i + 1) * (std::log(f(i)) + std::log1p(-f(n - 1 - i)));
  }
  return -static_cast<double>(n) - sum / static_cast<double>(n);
}

double anderson_darling_p_value(double statistic) {
  return std::min(1.0, std::sqrt(3.0) * std::erfc(std::sqrt(std::max(statistic, 0.0))));
}

KolmogorovSmirnov test_kolmogorov_smirnov(const Vector& values) {
  require_unit_interval(values);
  Vector sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const auto n = static_cast<double>(sorted.size());
  KolmogorovSmirnov test;
  for (Index i = 0; i < sorted.size(); ++i) {
    const double below = static_cast<double>(i) / n, above = static_cast<double>(i + 1) / n;
    test.statistic = std::max({test.statistic, sorted(i) - below, above - sorted(i)});
  }
  test.p_value = kolmogorov_smirnov_p_value(test.statistic, sorted.size());
  return test;
}

ChiSquare test_chi_square(const Vector& values, Index num_bins) {
  require_unit_interval(values);
  if (num_bins < 2) {
    throw InputError("test of uniformity: " + std::to_string(num_bins) + " bins, must be >= 2");
  }
  ChiSquare test;
  test.counts.assign(static_cast<std::size_t>(num_bins), 0);
  for (const double value : values) {
    const auto bin = static_cast<Index>(value * static_cast<double>(num_bins));
    ++test.counts[static_cast<std::size_t>(std::min(bin, num_bins - 1))];
  }
  const double expected = static_cast<double>(values.size()) / static_cast<double>(num_bins);
  for (const Index count : test.counts) {
    const double gap = static_cast<double>(count) - expected;
    test.statistic += gap * gap / expected;
  }
  test.p_value =
      Eigen::numext::igammac(0.5 * static_cast<double>(num_bins - 1), 0.5 * test.statistic);
  return test;
}

Vector spread_ranks(const std::vector<Index>& ranks, Index num_samples, const StreamId& id) {
  Vector values(static_cast<Index>(ranks.size()));
  for (Index i = 0; i < values.size(); ++i) {
    const Index rank = ranks[static_cast<std::size_t>(i)];
    if (rank < 0 || rank > num_samples) {
      throw InputError("rank " + std::to_string(rank) + ", must be 0 to " +
                       std::to_string(num_samples));
    }
    StreamId of_row = id;
    of_row.row += static_cast<std::uint64_t>(i);
    values(i) = (static_cast<double>(rank) + Stream(of_row).uniform()) /
                static_cast<double>(num_samples + 1);
  }
  return values;
}

double corrected(double smallest_p_value, Index num_tests) {
  return std::min(1.0, smallest_p_value * static_cast<double>(num_tests));
}

}  // namespace npdr::inference
