#include "inference/diagnostics/two_samples.h"

#include <algorithm>

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

RowMatrixF standardized(const RowMatrix& x, const RowMatrix& reference) {
  const Eigen::RowVectorXd mean = reference.colwise().mean();
  const Eigen::ArrayXXd variance = (reference.rowwise() - mean).colwise().squaredNorm() /
                                   static_cast<double>(reference.rows() - 1);
  const Eigen::ArrayXXd deviation = (variance > 0.0).select(variance.sqrt(), 1.0);
  constexpr double farthest = 1e6;
  return ((x.rowwise() - mean).array().rowwise() / deviation.row(0))
      .max(-farthest)
      .min(farthest)
      .cast<float>();
}

}  // namespace npdr::inference
