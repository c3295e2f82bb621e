#include "inference/abc/feature_distance.h"

#include <cmath>
#include <numeric>
#include <vector>

#include "core/constants.h"
#include "core/error.h"
#include "inference/matrix_features.h"
#include "inference/row_blocks.h"

namespace npdr::inference {
namespace {

// So that squares of distances stay finite.
constexpr float kLargest = 1e30f;

// What distances are between: what lies far out counts by its logarithm for networks, and to
// keep it from setting the directions of the others, but here in full.
void place(const FeatureTransform& transform, const RowMatrixF& x, RowMatrixF& z) {
  if (transform.basis.cols() > 0) return transform.apply(x, z);
  transform.standardize(x, z);
  z = z.cwiseMax(-kLargest).cwiseMin(kLargest);
}

}  // namespace

Vector feature_distances(const FeatureSource& x, const FeatureTransform& transform,
                         const VectorF& x_o) {
  if (x_o.size() != transform.num_inputs() || x.num_features() != x_o.size()) {
    throw ShapeError("distances: " + std::to_string(x.num_features()) + " simulated and " +
                     std::to_string(x_o.size()) + " observed features, must be " +
                     std::to_string(transform.num_inputs()));
  }
  RowMatrixF observed;
  place(transform, x_o.transpose(), observed);
  Vector distances(x.num_rows());
  parallel_for(num_blocks(x.num_rows()), [&](Index b) {
    const Index begin = b * kBlockRows, count = std::min(kBlockRows, x.num_rows() - begin);
    std::vector<std::uint32_t> rows(static_cast<std::size_t>(count));
    std::iota(rows.begin(), rows.end(), static_cast<std::uint32_t>(begin));
    RowMatrixF features, z;
    x.gather(rows, 0, features);
    place(transform, features, z);
    distances.segment(begin, count) =
        (z.rowwise() - observed.row(0)).cast<double>().rowwise().norm();
  });
  return distances;
}

Vector mean_feature_distances(const RowMatrixF& x, const FeatureTransform& transform,
                              const VectorF& x_o) {
  const Index num_varying = num_varying_outputs(transform);
  Vector distances = feature_distances(MatrixFeatures(x), transform, x_o) /
                     std::sqrt(static_cast<double>(num_varying));
  for (Index i = 0; i < x.rows(); ++i) {
    if (num_varying == 0 || !x.row(i).allFinite()) {
      distances(i) = kNaN;
    }
  }
  return distances;
}

}  // namespace npdr::inference
