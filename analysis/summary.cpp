#include "analysis/summary.h"

#include <cmath>
#include <limits>

namespace npdr::analysis {

Summary summarize(const Eigen::Ref<const Vector>& values) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Summary summary;
  double sum = 0.0;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    sum += v;
    ++summary.n;
  }
  const auto n = static_cast<double>(summary.n);
  summary.n_failed = values.size() - summary.n;
  summary.mean = summary.n > 0 ? sum / n : nan;
  double squares = 0.0;
  for (const double v : values) {
    if (std::isfinite(v)) squares += (v - summary.mean) * (v - summary.mean);
  }
  summary.std = summary.n > 1 ? std::sqrt(squares / (n - 1.0)) : nan;
  return summary;
}

}  // namespace npdr::analysis
