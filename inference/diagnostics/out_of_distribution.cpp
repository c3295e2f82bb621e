#include "inference/diagnostics/out_of_distribution.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/error.h"
#include "inference/diagnostics/tail_probability.h"
#include "inference/diagnostics/uniformity.h"
#include "inference/feature_transform.h"
#include "inference/matrix_features.h"

namespace npdr::inference {
namespace {

constexpr Index kMostComponents = 20;
constexpr Index kRowsPerComponent = 20;

void check(const RowMatrixF& x, const VectorF& x_o) {
  if (x.cols() != x_o.size()) {
    throw ShapeError("out of distribution: simulations of " + std::to_string(x.cols()) +
                     " features, an observation of " + std::to_string(x_o.size()));
  }
  if (x.rows() < kFewestSimulations) {
    throw InputError("out of distribution: " + std::to_string(x.rows()) +
                     " simulations, must be at least " + std::to_string(kFewestSimulations));
  }
  if (!x.allFinite() || !x_o.allFinite()) {
    throw InputError("out of distribution: features hold NaN or infinity, must be finite");
  }
}

// The first components of `transform` that have 99 % of the variance between them: in the others,
// scaled to the same size, noise would hide what the first ones show. A whitening direction is one
// of unit length divided by its deviation.
void keep_leading_components(FeatureTransform& transform) {
  constexpr double share = 0.99;
  const double total = static_cast<double>((transform.inverse_deviation.array() > 0.0f).count());
  double sum = 0.0;
  Index kept = 0;
  while (kept < transform.basis.cols() && sum < share * total) {
    const double length = static_cast<double>(transform.basis.col(kept).norm());
    if (!(length > 0.0)) break;
    sum += 1.0 / (length * length);
    ++kept;
  }
  transform.basis.conservativeResize(Eigen::NoChange, std::max<Index>(kept, 1));
}

// Distances of rows of x: within the components, and beyond them.
class Distances {
 public:
  explicit Distances(const RowMatrixF& x) {
    const Index components = std::clamp(x.rows() / kRowsPerComponent, Index{1}, kMostComponents);
    whitening_ = fit_feature_transform(MatrixFeatures(x), components);
    keep_leading_components(whitening_);
    standardization_ = whitening_;
    standardization_.basis.resize(0, 0);
    directions_ = whitening_.basis;
    const Eigen::RowVectorXf lengths = directions_.colwise().norm();
    directions_.array().rowwise() /= (lengths.array() > 0.0f).select(lengths.array(), 1.0f);
    whitening_.apply(x, known_);
  }

  Index num_components() const { return directions_.cols(); }

  /// Columns: Mahalanobis, residual, nearest; (n, 3).
  RowMatrix of(const RowMatrixF& x) const {
    RowMatrixF z, standardized;
    whitening_.apply(x, z);
    standardization_.apply(x, standardized);
    standardized -= (standardized * directions_) * directions_.transpose();
    RowMatrix result(x.rows(), 3);
    result.col(0) = z.rowwise().norm().cast<double>();
    result.col(1) = standardized.rowwise().norm().cast<double>();
    for (Index i = 0; i < x.rows(); ++i) {
      const float nearest = (known_.rowwise() - z.row(i)).rowwise().squaredNorm().minCoeff();
      result(i, 2) = std::sqrt(static_cast<double>(nearest));
    }
    return result;
  }

 private:
  RowMatrixF known_;  // whitened
  FeatureTransform whitening_, standardization_;
  RowMatrixF directions_;  // (F, k), orthonormal
};

// A feature that all simulations agree on, and the observation doesn't: no distance says how far
// that is. Rounding of single precision is no difference.
bool leaves_what_is_constant(const RowMatrixF& x, const VectorF& x_o) {
  constexpr float rounding = 1e-5f;
  for (Index f = 0; f < x.cols(); ++f) {
    const float lowest = x.col(f).minCoeff(), highest = x.col(f).maxCoeff();
    const float size = std::abs(lowest);
    const bool is_constant = highest - lowest <= rounding * size;
    if (is_constant && std::abs(x_o(f) - lowest) > rounding * std::max(size, std::abs(x_o(f)))) {
      return true;
    }
  }
  return false;
}

Distance judge(const Vector& usual, double observed) {
  Vector sorted = usual;
  std::sort(sorted.begin(), sorted.end());
  return {observed, sorted(sorted.size() / 2), tail_probability(usual, observed)};
}

}  // namespace

OutOfDistribution test_out_of_distribution(const RowMatrixF& x, const VectorF& x_o) {
  check(x, x_o);
  const Index known = x.rows() / 2;
  const Distances distances(x.topRows(known));
  const RowMatrix usual = distances.of(x.bottomRows(x.rows() - known));
  const RowMatrix observed = distances.of(x_o.transpose());
  OutOfDistribution result;
  result.num_components = distances.num_components();
  result.num_reference = usual.rows();
  result.mahalanobis = judge(usual.col(0), observed(0, 0));
  const bool leaves = leaves_what_is_constant(x, x_o);
  result.residual =
      judge(usual.col(1), leaves ? std::numeric_limits<double>::infinity() : observed(0, 1));
  result.nearest = judge(usual.col(2), observed(0, 2));
  result.p_value = corrected(
      std::min({result.mahalanobis.p_value, result.residual.p_value, result.nearest.p_value}), 3);
  return result;
}

}  // namespace npdr::inference
