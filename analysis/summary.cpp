#include "analysis/summary.h"

#include <cmath>
#include <numbers>

#include "core/constants.h"

namespace npdr::analysis {

Summary summarize(const Eigen::Ref<const Vector>& values) {
  Summary summary;
  double sum = 0.0;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    sum += v;
    ++summary.n;
  }
  const auto n = static_cast<double>(summary.n);
  summary.n_failed = values.size() - summary.n;
  summary.mean = summary.n > 0 ? sum / n : kNaN;
  double squares = 0.0;
  for (const double v : values) {
    if (std::isfinite(v)) squares += (v - summary.mean) * (v - summary.mean);
  }
  summary.std = summary.n > 1 ? std::sqrt(squares / (n - 1.0)) : kNaN;
  return summary;
}

Summary summarize_periodic(const Eigen::Ref<const Vector>& values, double period, double center) {
  if (period <= 0.0) return summarize(values);
  const double to_angle = 2.0 * std::numbers::pi / period;
  double sine = 0.0, cosine = 0.0;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    sine += std::sin(v * to_angle);
    cosine += std::cos(v * to_angle);
  }
  const double mean = center + std::remainder(std::atan2(sine, cosine) / to_angle - center, period);
  const Vector differences =
      values.unaryExpr([&](double v) { return std::remainder(v - mean, period); });
  Summary summary = summarize(differences);
  if (summary.n == 0) return summary;
  summary.mean = mean;
  const double squares =
      differences.unaryExpr([](double d) { return std::isfinite(d) ? d * d : 0.0; }).sum();
  if (summary.n > 1) summary.std = std::sqrt(squares / static_cast<double>(summary.n - 1));
  return summary;
}

}  // namespace npdr::analysis
