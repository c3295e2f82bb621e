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

}  // namespace npdr::analysis
