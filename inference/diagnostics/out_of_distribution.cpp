#include "inference/diagnostics/out_of_distribution.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/constants.h"
#include "core/error.h"
#include "core/quantile.h"
#include "inference/diagnostics/tail_probability.h"
#include "inference/diagnostics/uniformity.h"
#include "inference/feature_transform.h"
#include "inference/matrix_features.h"

namespace npdr::inference {
namespace {

constexpr Index kMostComponents = 20;
constexpr double kKeptVariance = 0.99;  // share that the components have between them
constexpr float kRounding = 1e-5f;      // of a constant feature, relative
constexpr float kFarNearer = 0.01f;     // ratio of distances from 0

void require_finite(const RowMatrixF& x) {
  if (x.allFinite()) return;
  throw InputError("out of distribution: features hold NaN or infinity, must be finite");
}

// The first components of `transform` that have 99 % of the variance between them: in the others,
// scaled to the same size, noise would hide what the first ones show. A whitening direction is one
// of unit length divided by its deviation.
void keep_leading_components(FeatureTransform& transform) {
  const double total = static_cast<double>((transform.inverse_deviation.array() > 0.0f).count());
  double sum = 0.0;
  Index kept = 0;
  while (kept < transform.basis.cols() && sum < kKeptVariance * total) {
    const double length = static_cast<double>(transform.basis.col(kept).norm());
    if (!(length > 0.0)) break;
    sum += 1.0 / (length * length);
    ++kept;
  }
  transform.basis.conservativeResize(Eigen::NoChange, std::max<Index>(kept, 1));
}

// Columns: Mahalanobis, residual, nearest; (n, 3).
RowMatrix distances_of(const RowMatrixF& x, const UsualFeatures& usual) {
  RowMatrixF z, residual;
  usual.transform.apply(x, z);
  FeatureTransform standardization = usual.transform;
  standardization.basis.resize(0, 0);
  standardization.apply(x, residual);
  RowMatrixF directions = usual.transform.basis;  // orthonormal
  const Eigen::RowVectorXf lengths = directions.colwise().norm();
  directions.array().rowwise() /= (lengths.array() > 0.0f).select(lengths.array(), 1.0f);
  residual -= (residual * directions) * directions.transpose();
  RowMatrix result(x.rows(), 3);
  result.col(0) = z.rowwise().norm().cast<double>();
  result.col(1) = residual.rowwise().norm().cast<double>();
  for (Index i = 0; i < x.rows(); ++i) {
    const float nearest = (usual.known.rowwise() - z.row(i)).rowwise().squaredNorm().minCoeff();
    result(i, 2) = std::sqrt(static_cast<double>(nearest));
  }
  return result;
}

Distance judge(const Vector& usual, double observed) {
  return {observed, upper_median(usual), tail_probability(usual, observed)};
}

}  // namespace

UsualFeatures usual_features(const RowMatrixF& x, Tails tails) {
  if (x.rows() < kFewestSimulations) {
    throw InputError("out of distribution: " + std::to_string(x.rows()) +
                     " simulations, must be at least " + std::to_string(kFewestSimulations));
  }
  require_finite(x);
  const Index known = x.rows() / 2;
  const RowMatrixF first_half = x.topRows(known);
  const Index components = std::clamp(known / kRowsPerComponent, Index{1}, kMostComponents);
  UsualFeatures usual;
  usual.transform = fit_feature_transform(MatrixFeatures(first_half), components, tails);
  keep_leading_components(usual.transform);
  usual.transform.apply(first_half, usual.known);
  usual.distances = distances_of(x.bottomRows(x.rows() - known), usual);
  usual.lowest = x.colwise().minCoeff();
  usual.highest = x.colwise().maxCoeff();
  return usual;
}

namespace {

// Rounding of single precision is no difference.
bool is_changed_constant(float lowest, float highest, float observed) {
  const float size = std::abs(lowest);
  const bool is_constant = highest - lowest <= kRounding * size;
  return is_constant &&
         std::abs(observed - lowest) > kRounding * std::max(size, std::abs(observed));
}

// Of features on one side of 0, the observed one on that side, too, or not. Of counts 0 is next
// to 1.
bool is_nearer_to_zero(float least, float observed) {
  const float unit = least == std::round(least) ? 1.0f : 0.0f;
  return least > 0.0f && observed + unit < kFarNearer * (least + unit);
}

}  // namespace

// No distance says how far that is.
std::optional<Index> impossible_feature(const UsualFeatures& usual, const VectorF& x_o) {
  const VectorF& scale = usual.transform.inverse_scale;
  for (Index f = 0; f < x_o.size(); ++f) {
    const float lowest = usual.lowest(f), highest = usual.highest(f);
    if (is_changed_constant(lowest, highest, x_o(f))) return f;
    const bool is_compressed = scale.size() > 0 && scale(f) > 0.0f;
    if (!is_compressed) continue;
    if (is_nearer_to_zero(lowest, x_o(f)) || is_nearer_to_zero(-highest, -x_o(f))) return f;
  }
  return std::nullopt;
}

OutOfDistribution test_out_of_distribution(const UsualFeatures& usual, const VectorF& x_o) {
  if (usual.lowest.size() != x_o.size()) {
    throw ShapeError("out of distribution: simulations of " + std::to_string(usual.lowest.size()) +
                     " features, an observation of " + std::to_string(x_o.size()));
  }
  require_finite(x_o);
  const RowMatrix observed = distances_of(x_o.transpose(), usual);
  OutOfDistribution result;
  result.num_components = usual.transform.basis.cols();
  result.num_reference = usual.distances.rows();
  result.mahalanobis = judge(usual.distances.col(0), observed(0, 0));
  const bool leaves = impossible_feature(usual, x_o).has_value();
  result.residual = judge(usual.distances.col(1), leaves ? kInfinity : observed(0, 1));
  result.nearest = judge(usual.distances.col(2), observed(0, 2));
  result.p_value = corrected(
      std::min({result.mahalanobis.p_value, result.residual.p_value, result.nearest.p_value}), 3);
  return result;
}

bool can_be_outside(Index num_reference, double level) {
  return 3.0 * smallest_tail_probability(num_reference) < level;
}

}  // namespace npdr::inference
