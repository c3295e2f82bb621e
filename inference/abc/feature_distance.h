/// Distances of the features of simulations from those that were observed.
#pragma once

#include "inference/feature_source.h"
#include "inference/feature_transform.h"

namespace npdr::inference {

/// |z(x_i) - z(x_o)|, Euclidean, of every row of `x` (n): z is the transform's, clamped only where
/// it projects, so that every feature counts in its own deviations. Features are those of epoch 0.
/// Parallel, with the same bits on any number of threads; memory doesn't grow with the width of all
/// rows. Throws ShapeError when x_o has another number of features.
Vector feature_distances(const FeatureSource& x, const FeatureTransform& transform,
                         const VectorF& x_o);

/// The same of x (n, F) as a root of the mean over the F' outputs of z that vary, (n):
///   d_i = |z(x_i) - z(x_o)| / sqrt(F').
/// NaN for a row that isn't finite, and where no output varies. Throws ShapeError as above.
Vector mean_feature_distances(const RowMatrixF& x, const FeatureTransform& transform,
                              const VectorF& x_o);

}  // namespace npdr::inference
