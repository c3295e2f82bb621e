#include "inference/informative_features.h"

#include <algorithm>
#include <cmath>

#include "core/matrix_blocking.h"
#include "inference/feature_blocks.h"

namespace npdr::inference {
namespace {

constexpr Index kMostRows = 10'000;
constexpr double kFarthest = 3.0;         // deviations
constexpr double kStandardErrors = 5.0;   // of a correlation
constexpr double kLeastVariance = 1e-12;  // of a standardized feature that varies, or its square

// The columns of z and their squares.
RowMatrix with_squares(const RowMatrix& z) {
  RowMatrix both(z.rows(), 2 * z.cols());
  both << z, z.array().square().matrix();
  return both;
}

// Columns of mean 0 and variance 1; of 0 where they don't vary.
RowMatrix standardized_columns(RowMatrix values) {
  values.rowwise() -= values.colwise().mean().eval();
  const auto n = static_cast<double>(values.rows());
  const Eigen::ArrayXd variance = values.colwise().squaredNorm().transpose().array() / n;
  const Eigen::ArrayXd scale = (variance > 0.0).select(1.0 / variance.sqrt(), 0.0);
  return values.array().rowwise() * scale.transpose();
}

}  // namespace

std::vector<Index> informative_features(const FeatureSource& x, const FeatureTransform& transform,
                                        const RowMatrix& u) {
  fix_matrix_blocking();
  const Index n = std::min(u.rows(), kMostRows), features = x.num_features();
  FeatureTransform standardization = transform;
  standardization.basis.resize(0, 0);
  const RowMatrix targets = standardized_columns(with_squares(u.topRows(n)));
  RowMatrix products = RowMatrix::Zero(2 * features, targets.cols());
  Vector sums = Vector::Zero(2 * features), squares = Vector::Zero(2 * features);
  RowMatrixF z;
  for_each_block(x, n, [&](Index begin, const RowMatrixF& rows) {
    standardization.apply(rows, z);
    const RowMatrix block = with_squares(z.cast<double>().cwiseMax(-kFarthest).cwiseMin(kFarthest));
    products.noalias() += block.transpose() * targets.middleRows(begin, block.rows());
    sums += block.colwise().sum().transpose();
    squares += block.colwise().squaredNorm().transpose();
  });
  const auto count = static_cast<double>(n);
  const Eigen::ArrayXd variance = (squares - sums.cwiseProduct(sums) / count).array() / count;
  // |products / n| / deviation > 5 / sqrt(n), as targets have mean 0 and variance 1.
  const Eigen::ArrayXd largest = products.cwiseAbs().rowwise().maxCoeff().array();
  const auto tells = [&](Index k) {
    return largest(k) > kStandardErrors * std::sqrt(count * std::max(variance(k), kLeastVariance));
  };
  std::vector<Index> informative;
  for (Index j = 0; j < features; ++j) {
    if (tells(j) || tells(features + j)) informative.push_back(j);
  }
  return informative;
}

}  // namespace npdr::inference
