/// Simulated feature vectors x against an observed one.
#pragma once

#include <array>
#include <span>

#include "analysis/summary.h"
#include "core/types.h"

namespace npdr::analysis {

/// Standard deviation of each feature over rows that are added one by one (Welford 1962).
class FeatureSpread {
 public:
  explicit FeatureSpread(Index num_features);
  /// x: (F). Throws ShapeError for another length.
  void add(std::span<const float> x);
  /// (F), with n - 1 in the denominator; 0 for fewer than two rows.
  Vector deviation() const;

 private:
  Index count_ = 0;
  Vector mean_;
  Vector sum_of_squares_;  ///< of the distances from the mean
};

/// The distance of each row of x (n, F) from x_o (F), in units of `deviation` (F), (n):
///   d_i = sqrt( (1/F') sum_f ((x_if - x_of) / deviation_f)^2 ),
/// over the F' features with a deviation > 0. NaN for a row that isn't finite, and where no feature
/// varies. Throws ShapeError for widths that don't agree.
Vector feature_distance(const Eigen::Ref<const RowMatrixF>& x, const Vector& x_o,
                        const Vector& deviation);

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
