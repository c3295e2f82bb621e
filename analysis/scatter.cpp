#include "analysis/scatter.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/quantile.h"

namespace npdr::analysis {
namespace {

Vector differences(const Vector& values) {
  return values.tail(values.size() - 1) - values.head(values.size() - 1);
}

double median_size(const Vector& values) { return quantile(Vector(values.cwiseAbs()), 0.5); }

// Smaller steps come from the arithmetic of whoever wrote the numbers.
double dust_of(const Vector& series) { return 1e-9 * series.cwiseAbs().maxCoeff(); }

double rounding_of(const Vector& series) { return smallest_step(series) / std::sqrt(12.0); }

}  // namespace

double smallest_step(const Vector& series) {
  const double dust = dust_of(series);
  double smallest = kInfinity;
  for (const double step : differences(series)) {
    if (std::abs(step) > dust) smallest = std::min(smallest, std::abs(step));
  }
  return std::isfinite(smallest) ? smallest : 0.0;
}

double scatter(const Vector& series) {
  if (series.size() < 4) return 0.0;
  const Vector first = differences(series);
  const double third = median_size(differences(differences(first))), dust = dust_of(series);
  if (third > dust || median_size(first) > dust) return 1.4826 * third / std::sqrt(20.0);
  return rounding_of(series);
}

double scatter_of(const Target& recording) {
  Vector of_channels = Vector::Zero(recording.num_states());
  for (const Rollout& rollout : recording.rollouts) {
    for (Index c = 0; c < recording.num_states(); ++c) {
      const Vector series = rollout.states.col(c);
      const double largest = series.cwiseAbs().maxCoeff();
      if (largest == 0.0) continue;
      of_channels(c) += std::max(scatter(series), rounding_of(series)) / largest;
    }
  }
  return of_channels.maxCoeff() / static_cast<double>(recording.num_rollouts());
}

}  // namespace npdr::analysis
