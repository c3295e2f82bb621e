/// Smooth marginal densities for plots.
#pragma once

#include "core/types.h"

namespace npdr::analysis {

/// Gaussian kernel density estimate of `samples` (n) on `num_points` evenly spaced points of
/// [lower, upper]: (num_points, 2) of position and density. Bandwidth 0.9 min(std, IQR / 1.34)
/// n^(-1/5) (Silverman 1986, eq. 3.31), but not under one spacing; samples are first shared between
/// the two nearest points (linear binning: Wand 1994), so the cost doesn't grow with n times
/// num_points. Kernels are reflected at the ends, so that a density that is cut off there doesn't
/// sag. Samples outside [lower, upper] count in n, so the curve integrates to the share of the
/// samples inside; values that aren't finite are left out. All zero when there are no samples.
/// Throws InputError unless lower < upper and num_points >= 2.
RowMatrix density_curve(const Eigen::Ref<const Vector>& samples, double lower, double upper,
                        Index num_points = 256);

}  // namespace npdr::analysis
