#include "inference/feature_transform.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/constants.h"
#include "core/decompositions.h"
#include "core/error.h"
#include "core/matrix_blocking.h"
#include "core/quantile.h"
#include "inference/feature_blocks.h"
#include "inference/heavy_tails.h"

namespace npdr::inference {
namespace {

constexpr float kUsualRanges = 20.0f;  // beyond the usual one, until values are clamped
constexpr double kNearlyAll = 0.99;    // share of one value, above which a feature hardly varies
constexpr auto kRounding = static_cast<float>(kFloatRounding);  // of a constant feature

/// Bounds of what is usual, column by column, (F + K).
struct Bounds {
  Eigen::ArrayXf lower, upper;
};

Index num_compressed(const FeatureTransform& transform) {
  return (transform.inverse_scale.array() > 0.0f).count();
}

// Features and copies (n, F + K) of x (n, F): those that have a scale are compressed.
RowMatrixF columns_of(const FeatureTransform& transform, const RowMatrixF& x, bool has_copies) {
  RowMatrixF columns(x.rows(), x.cols() + (has_copies ? num_compressed(transform) : 0));
  columns.leftCols(x.cols()) = x;
  Index copy = x.cols();
  for (Index f = 0; f < transform.center.size(); ++f) {
    if (transform.inverse_scale(f) == 0.0f) continue;
    if (has_copies) columns.col(copy++) = x.col(f);
    columns.col(f) = x.col(f).unaryExpr([&](float value) {
      return compressed(value, transform.center(f), transform.inverse_scale(f));
    });
  }
  return columns;
}

struct Range {
  float low, high;
};

bool is_constant(const Range& range) {
  return !(range.high - range.low >
           kRounding * std::max(std::abs(range.low), std::abs(range.high)));
}

// Where the usual values lie. One that nearly all rows share hides what the others are: then as far
// from it as 95 % of these, on both sides.
Range usual_range(std::vector<float> values) {
  std::ranges::sort(values);
  const Range range{lower_quantile(values, 0.05), lower_quantile(values, 0.95)};
  if (!is_constant(range)) return range;
  const float center = lower_quantile(values, 0.5);
  std::vector<float> distances;
  for (const float value : values) {
    if (is_constant({std::min(value, center), std::max(value, center)})) continue;
    distances.push_back(std::abs(value - center));
  }
  if (distances.empty()) return range;
  std::ranges::sort(distances);
  const float reach = lower_quantile(distances, 0.95);
  return {center - reach, center + reach};
}

// Bounds from the first columns. One that doesn't vary there has no bounds.
template <class Columns>
Bounds usual_bounds(const FeatureSource& x, Index num_columns, const Columns& columns_of_rows) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Bounds bounds{Eigen::ArrayXf::Constant(num_columns, -infinity),
                Eigen::ArrayXf::Constant(num_columns, infinity)};
  // One block: bounds are those of its rows.
  for_each_block(x, std::min(kRowsOfBlock, x.num_rows()), [&](Index, const RowMatrixF& rows) {
    const RowMatrixF columns = columns_of_rows(rows);
    for (Index f = 0; f < num_columns; ++f) {
      const Range range = usual_range({columns.col(f).begin(), columns.col(f).end()});
      if (is_constant(range)) continue;
      bounds.lower(f) = range.low - kUsualRanges * (range.high - range.low);
      bounds.upper(f) = range.high + kUsualRanges * (range.high - range.low);
    }
  });
  return bounds;
}

// Values that lie far out keep their order.
void slow_down(RowMatrixF& z) {
  constexpr float farthest = FeatureTransform::kFarthest;
  if (z.size() == 0 || z.cwiseAbs().maxCoeff() <= farthest) return;
  z = z.unaryExpr([](float value) {
    const float size = std::abs(value);
    if (size <= farthest) return value;
    return std::copysign(farthest + std::log(std::min(size, 1e36f) / farthest), value);
  });
}

RowMatrixF first_rows(const FeatureSource& x) {
  RowMatrixF first(std::min(x.num_rows(), kFirstRows), x.num_features());
  for_each_block(x, first.rows(), [&](Index begin, const RowMatrixF& rows) {
    first.middleRows(begin, rows.rows()) = rows;
  });
  return first;
}

// The share of the value that is there most often.
double largest_share(std::vector<float> values) {
  std::ranges::sort(values);
  std::ptrdiff_t most = 0;
  for (auto first = values.begin(); first != values.end();) {
    const auto last = std::upper_bound(first, values.end(), *first);
    most = std::max(most, last - first);
    first = last;
  }
  return static_cast<double>(most) / static_cast<double>(values.size());
}

void find_heavy_tails(const FeatureSource& x, FeatureTransform& transform) {
  const RowMatrixF first = first_rows(x);
  VectorF center = VectorF::Zero(x.num_features()), inverse_scale = center;
  for (Index f = 0; f < first.cols(); ++f) {
    const auto found = compression_of({first.col(f).begin(), first.col(f).end()});
    if (!found) continue;
    center(f) = found->center;
    inverse_scale(f) = 1.0f / found->scale;
  }
  if (inverse_scale.isZero(0.0f)) return;
  transform.center = std::move(center);
  transform.inverse_scale = std::move(inverse_scale);
}

// Mean and deviation by Welford's algorithm (1962), which doesn't cancel.
FeatureTransform standardization(const FeatureSource& x, Tails tails) {
  FeatureTransform transform;
  if (tails != Tails::kept) find_heavy_tails(x, transform);
  const bool has_copies = tails == Tails::both;
  const auto columns_of_rows = [&](const RowMatrixF& rows) {
    return columns_of(transform, rows, has_copies);
  };
  const Index num_columns = x.num_features() + (has_copies ? num_compressed(transform) : 0);
  const Bounds bounds = usual_bounds(x, num_columns, columns_of_rows);
  Vector mean = Vector::Zero(num_columns);
  Vector squares = Vector::Zero(num_columns);
  double count = 0.0;
  for_each_block(x, x.num_rows(), [&](Index, const RowMatrixF& rows) {
    const RowMatrixF columns = columns_of_rows(rows);
    for (Index i = 0; i < columns.rows(); ++i) {
      count += 1.0;
      const Vector value = columns.row(i)
                               .transpose()
                               .array()
                               .max(bounds.lower)
                               .min(bounds.upper)
                               .matrix()
                               .cast<double>();
      const Vector before = value - mean;
      mean += before / count;
      squares.array() += before.array() * (value - mean).array();
    }
  });
  const Eigen::ArrayXd deviation = (squares.array() / count).sqrt();
  // Rounding leaves a little variance in a constant feature of single precision.
  const Eigen::ArrayXd smallest =
      double{kRounding} * mean.array().abs() + FeatureTransform::kLeastDeviation;
  transform.mean = mean.cast<float>();
  transform.inverse_deviation = (deviation > smallest).select(1.0 / deviation, 0.0).cast<float>();
  return transform;
}

// Eigenvectors of z^T z / n with the largest eigenvalues, each over the root of its eigenvalue, (F,
// components). For more features than rows through z z^T, which is smaller and has the same ones.
RowMatrixF whitening_directions(const RowMatrix& z, Index components) {
  const bool wide = z.cols() > z.rows();
  const Eigen::MatrixXd product =
      (wide ? Eigen::MatrixXd(z * z.transpose()) : Eigen::MatrixXd(z.transpose() * z)) /
      static_cast<double>(z.rows());
  const SymmetricEigen eigen(product);
  const Eigen::MatrixXd leading = eigen.vectors.rightCols(components).rowwise().reverse();
  RowMatrix directions = wide ? RowMatrix(z.transpose() * leading) : RowMatrix(leading);
  const Eigen::RowVectorXd lengths = directions.colwise().norm();
  directions.array().rowwise() /= (lengths.array() > 0.0).select(lengths.array(), 1.0);
  const Eigen::ArrayXd values = eigen.values.tail(components).reverse();
  // A direction without variance carries nothing.
  const Eigen::ArrayXd scale = (values > 1e-9 * values(0)).select(1.0 / values.sqrt(), 0.0);
  return (directions.array().rowwise() * scale.transpose()).cast<float>();
}

RowMatrix first_standardized_rows(const FeatureSource& x, const FeatureTransform& transform) {
  RowMatrixF z;
  transform.apply(first_rows(x), z);
  return z.cast<double>();
}

std::vector<Index> varying_columns(const FeatureTransform& transform) {
  const bool projects = transform.basis.cols() > 0;
  std::vector<Index> varying;
  for (Index k = 0; k < transform.num_outputs(); ++k) {
    const bool varies = projects ? transform.basis.col(k).squaredNorm() > 0.0f
                                 : transform.inverse_deviation(k) > 0.0f;
    if (varies) varying.push_back(k);
  }
  return varying;
}

}  // namespace

void FeatureTransform::standardize(const RowMatrixF& x, RowMatrixF& z) const {
  z = columns_of(*this, x, num_copies() > 0);
  z = (z.rowwise() - mean.transpose()).array().rowwise() * inverse_deviation.transpose().array();
}

void FeatureTransform::apply(const RowMatrixF& x, RowMatrixF& z) const {
  const bool projects = basis.cols() > 0;
  RowMatrixF unprojected;
  RowMatrixF& standardized = projects ? unprojected : z;
  standardize(x, standardized);
  slow_down(standardized);
  if (projects) z.noalias() = standardized * basis;
}

Index num_varying_outputs(const FeatureTransform& transform) {
  return std::ssize(varying_columns(transform));
}

FeatureTransform without_copies(FeatureTransform transform) {
  const Index inputs = transform.num_inputs();
  transform.mean.conservativeResize(inputs);
  transform.inverse_deviation.conservativeResize(inputs);
  return transform;
}

FeatureTransform selected_outputs(const FeatureTransform& transform,
                                  const std::vector<Index>& outputs) {
  const Index count = std::ssize(outputs);
  FeatureTransform result = transform;
  if (transform.basis.cols() > 0) {
    result.basis = transform.basis(Eigen::all, outputs);
    return result;
  }
  result.basis = RowMatrixF::Zero(transform.mean.size(), count);
  for (Index k = 0; k < count; ++k) result.basis(outputs[static_cast<std::size_t>(k)], k) = 1.0f;
  return result;
}

std::vector<Index> varying_features(const std::vector<Index>& features, const FeatureSource& x) {
  const RowMatrixF first = first_rows(x);
  std::vector<Index> varying = features;
  std::erase_if(varying, [&](Index f) {
    return largest_share({first.col(f).begin(), first.col(f).end()}) > kNearlyAll;
  });
  return varying.empty() ? features : varying;
}

FeatureTransform varying_outputs(const FeatureTransform& transform, const FeatureSource& x) {
  std::vector<Index> varying = varying_columns(transform);
  if (varying.empty()) throw InputError("no feature of x varies among the simulations");
  if (transform.basis.cols() == 0) varying = varying_features(varying, x);
  if (std::ssize(varying) == transform.num_outputs()) return transform;
  return selected_outputs(transform, varying);
}

FeatureTransform fit_feature_transform(const FeatureSource& x, Index components, Tails tails) {
  fix_matrix_blocking();
  FeatureTransform transform = standardization(x, tails);
  if (components == 0) return transform;
  const Index most = std::min({components, x.num_features(), x.num_rows(), kFirstRows});
  transform.basis = whitening_directions(first_standardized_rows(x, transform), most);
  return transform;
}

}  // namespace npdr::inference
