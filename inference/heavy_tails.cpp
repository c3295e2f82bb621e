#include "inference/heavy_tails.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/quantile.h"
#include "core/types.h"

namespace npdr::inference {
namespace {

constexpr std::size_t kFewestValues = 100;
constexpr double kLeastGain = 0.2;    // [nats] of each value
constexpr int kHalvings = 7;          // of the share of distances
constexpr double kStrays = 0.01;      // share of distances, too small to be a scale
constexpr double kHeavy = 2.0;        // ratio of the whole range to the usual one
constexpr double kWide = 30.0;        // ratio of the usual magnitudes
constexpr double kFewOfOther = 0.05;  // share of values of the other sign
constexpr double kOutliers = 0.002;   // share at either end
constexpr double kSmallest = 1e-30;   // scale
constexpr double kTail = 0.05;        // beyond the usual range, at either end
constexpr double kFarTail = 0.005;    // beyond the whole range

double log_deviation(const Eigen::ArrayXd& values) {
  return 0.5 * std::log((values - values.mean()).square().mean());
}

// Log likelihood of each value if t is normal with its own mean and variance, but for a constant.
double log_likelihood(const Eigen::ArrayXd& values, double center, double scale) {
  const Eigen::ArrayXd v = (values - center) / scale;
  const Eigen::ArrayXd t = v.unaryExpr([](double a) { return std::asinh(a); });
  return -log_deviation(t) - 0.5 * v.square().log1p().mean() - std::log(scale);
}

// Distances from the center but 0, ascending.
std::vector<double> distances_from(double center, const std::vector<double>& values) {
  std::vector<double> distances;
  for (const double value : values) {
    if (value != center) distances.push_back(std::abs(value - center));
  }
  std::ranges::sort(distances);
  return distances;
}

// The best compression of sorted values, and by how much.
class Search {
 public:
  explicit Search(const std::vector<double>& sorted)
      : usual_(Eigen::Map<const Eigen::ArrayXd>(sorted.data(), std::ssize(sorted))
                   .max(lower_quantile(sorted, kOutliers))
                   .min(lower_quantile(sorted, 1.0 - kOutliers))) {}

  const std::optional<Compression>& found() const { return found_; }

  // Of values at the center itself, as many as they may be, every scale makes the same.
  void look_around(double center) {
    const auto distances = distances_from(center, {usual_.begin(), usual_.end()});
    if (distances.size() < kFewestValues) return;
    Eigen::ArrayXd values(std::ssize(distances));
    std::ranges::copy_if(usual_, values.begin(), [&](double v) { return v != center; });
    const double before = -log_deviation(values);
    const double least = std::max({kSmallest, kFloatRounding * std::abs(center),
                                   distances.back() / Compression::kLargestRatio,
                                   lower_quantile(distances, kStrays)});
    for (int k = 0; k <= kHalvings; ++k) {
      const double scale = std::max(least, lower_quantile(distances, std::ldexp(1.0, -k)));
      const double gain = log_likelihood(values, center, scale) - before;
      if (!(gain > best_)) continue;
      best_ = gain;
      found_ = Compression{static_cast<float>(center), static_cast<float>(scale)};
    }
  }

 private:
  Eigen::ArrayXd usual_;
  double best_ = kLeastGain;
  std::optional<Compression> found_;
};

bool is_of_one_sign(const std::vector<double>& values) {
  const auto positive = std::ranges::count_if(values, [](double v) { return v > 0.0; });
  const auto negative = std::ranges::count_if(values, [](double v) { return v < 0.0; });
  return static_cast<double>(std::min(positive, negative)) <=
         kFewOfOther * static_cast<double>(positive + negative);
}

bool is_wide(const std::vector<double>& magnitudes) {
  return !magnitudes.empty() &&
         lower_quantile(magnitudes, 1.0 - kTail) >= kWide * lower_quantile(magnitudes, kTail);
}

}  // namespace

std::optional<Compression> compression_of(std::vector<float> values) {
  if (values.size() < kFewestValues) return std::nullopt;
  std::ranges::sort(values);
  const std::vector<double> sorted(values.begin(), values.end());
  const double low = lower_quantile(sorted, kTail), high = lower_quantile(sorted, 1.0 - kTail);
  const double whole = lower_quantile(sorted, 1.0 - kFarTail) - lower_quantile(sorted, kFarTail);
  const bool is_heavy = whole > 0.0 && whole >= kHeavy * (high - low);
  Search search(sorted);
  if (is_heavy) {
    for (const double center : {low, lower_quantile(sorted, 0.5), high}) search.look_around(center);
  }
  if (is_of_one_sign(sorted) && (is_heavy || is_wide(distances_from(0.0, sorted)))) {
    search.look_around(0.0);
  }
  return search.found();
}

float compressed(float value, float center, float inverse_scale) {
  constexpr auto most = static_cast<float>(Compression::kLargestRatio);
  return std::asinh(std::clamp((value - center) * inverse_scale, -most, most));
}

}  // namespace npdr::inference
