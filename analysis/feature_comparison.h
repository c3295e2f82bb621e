/// Simulated feature vectors x against an observed one.
#pragma once

#include <array>

#include "analysis/summary.h"
#include "core/types.h"

namespace npdr::analysis {

/// Summary of one feature over rows of a posterior predictive distribution.
struct FeaturePrediction {
  Summary summary;                  ///< of the finite values
  std::array<double, 3> quantiles;  ///< 5, 50 and 95 %
  double tail = 0.0;                ///< P(x < x_o) + P(x = x_o) / 2; near 0 or 1: x_o is a surprise
};

/// Compares the values of one feature with the observed one; those that aren't finite are left out.
/// NaN where none is left.
FeaturePrediction predict_feature(const Eigen::Ref<const Vector>& values, double x_o);

}  // namespace npdr::analysis
