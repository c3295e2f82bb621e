#include "inference/diagnostics/two_samples.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"

namespace npdr::inference {

void require_two_samples(const std::string& test, const RowMatrix& first, const RowMatrix& second) {
  if (first.cols() != second.cols() || first.cols() < 1) {
    throw ShapeError(test + ": samples of " + std::to_string(first.cols()) + " and " +
                     std::to_string(second.cols()) + " columns, must be as many and at least 1");
  }
  const Index rows = std::min(first.rows(), second.rows());
  if (rows < kFewestRowsOfSample) {
    throw InputError(test + ": a sample of " + std::to_string(rows) + " rows, must be at least " +
                     std::to_string(kFewestRowsOfSample));
  }
  if (!first.allFinite() || !second.allFinite()) {
    throw InputError(test + ": a sample holds NaN or infinity, must be finite");
  }
}

RowMatrix pooled(const RowMatrix& first, const RowMatrix& second) {
  RowMatrix both(first.rows() + second.rows(), first.cols());
  both << first, second;
  return both;
}

std::vector<ColumnMoments> column_moments(const RowMatrix& x) {
  std::vector<ColumnMoments> moments;
  for (Index d = 0; d < x.cols(); ++d) {
    // A power of two rounds nothing.
    int exponent = 0;
    std::frexp(x.col(d).cwiseAbs().maxCoeff(), &exponent);
    const Eigen::ArrayXd scaled =
        x.col(d).unaryExpr([exponent](double value) { return std::ldexp(value, -exponent); });
    const double mean = scaled.mean();
    const double variance = (scaled - mean).square().sum() / static_cast<double>(scaled.size() - 1);
    moments.push_back({std::ldexp(mean, exponent), std::ldexp(std::sqrt(variance), exponent)});
  }
  return moments;
}

Index num_repeated_rows(const RowMatrix& x) {
  std::vector<Index> order(static_cast<std::size_t>(x.rows()));
  std::iota(order.begin(), order.end(), Index{0});
  const auto compare = [&](Index a, Index b) {
    return std::lexicographical_compare_three_way(x.row(a).begin(), x.row(a).end(),
                                                  x.row(b).begin(), x.row(b).end());
  };
  std::ranges::sort(order, [&](Index a, Index b) { return compare(a, b) < 0; });
  return std::ssize(
      std::ranges::unique(order, [&](Index a, Index b) { return compare(a, b) == 0; }));
}

RowMatrixF standardized(const RowMatrix& x, const RowMatrix& reference) {
  constexpr double farthest = 1e6;
  const std::vector<ColumnMoments> moments = column_moments(reference);
  RowMatrixF result(x.rows(), x.cols());
  for (Index d = 0; d < x.cols(); ++d) {
    const auto [mean, deviation] = moments[static_cast<std::size_t>(d)];
    // Halves: the difference of two numbers may be larger than any.
    const double unit = deviation > 0.0 ? 0.5 * deviation : 0.5;
    result.col(d) =
        ((0.5 * x.col(d).array() - 0.5 * mean) / unit).max(-farthest).min(farthest).cast<float>();
  }
  return result;
}

}  // namespace npdr::inference
