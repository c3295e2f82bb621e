#include "inference/heavy_tails.h"

#include <algorithm>
#include <cmath>

#include "core/types.h"

namespace npdr::inference {
namespace {

constexpr std::size_t kFewestValues = 100;
constexpr double kLeastGain = 0.2;                    // nats
constexpr int kHalvings = 12;                         // of the range
constexpr double kHeavy = 2.0;                        // of the whole range to the usual one
constexpr double kWide = 30.0;                        // of magnitudes
constexpr double kSmallest = 1e-30, kLargest = 1e30;  // scale, and values over it: floats
constexpr double kUsualRanges = 20.0;                 // beyond the quantiles, where values end

double quantile_of(const std::vector<float>& sorted, double p) {
  return sorted[static_cast<std::size_t>(p * static_cast<double>(sorted.size() - 1))];
}

double log_deviation(const Eigen::ArrayXd& values) {
  return 0.5 * std::log((values - values.mean()).square().mean());
}

// Log likelihood of each value if t is normal with its own mean and variance, but for a constant.
double log_likelihood(const Eigen::ArrayXd& values, double center, double scale) {
  const Eigen::ArrayXd v = (values - center) / scale;
  const Eigen::ArrayXd t = v.unaryExpr([](double a) { return std::asinh(a); });
  return -log_deviation(t) - 0.5 * v.square().log1p().mean() - std::log(scale);
}

}  // namespace

std::optional<Compression> compression_of(std::vector<float> values) {
  std::ranges::sort(values);
  values.erase(std::ranges::unique(values).begin(), values.end());
  if (values.size() < kFewestValues) return std::nullopt;
  const double low = quantile_of(values, 0.05), high = quantile_of(values, 0.95);
  const double range = high - low;
  const Eigen::ArrayXd usual = Eigen::Map<const VectorF>(values.data(), std::ssize(values))
                                   .cast<double>()
                                   .array()
                                   .max(low - kUsualRanges * range)
                                   .min(high + kUsualRanges * range);
  double best = -log_deviation(usual) + kLeastGain;
  std::optional<Compression> found;
  const auto consider = [&](double center, double scale) {
    const double farthest = (usual - center).abs().maxCoeff();
    if (!(scale > kSmallest && farthest < kLargest * scale)) return;
    const double here = log_likelihood(usual, center, scale);
    if (!(here > best)) return;
    best = here;
    found = Compression{static_cast<float>(center), static_cast<float>(scale)};
  };
  const double whole = quantile_of(values, 0.995) - quantile_of(values, 0.005);
  if (whole >= kHeavy * range) {
    for (const double center : {low, quantile_of(values, 0.5), high}) {
      for (int k = 0; k <= kHalvings; ++k) consider(center, std::ldexp(range, -k));
    }
  }
  // Of one sign, the smallest magnitude.
  const double least = std::max(values.front(), -values.back());
  if (least > 0.0 && std::max(high / low, low / high) >= kWide) consider(0.0, least);
  return found;
}

}  // namespace npdr::inference
