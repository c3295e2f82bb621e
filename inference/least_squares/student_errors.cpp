#include "inference/least_squares/student_errors.h"

#include <cmath>

#include "core/constants.h"

namespace npdr::inference {

Vector StudentErrors::scales(const RowMatrix& errors, const Vector& guess) const {
  constexpr int num_steps = 20;
  const double nu = degrees_of_freedom;
  Vector scales = smallest_scales;
  for (Index c = 0; c < errors.cols(); ++c) {
    const Eigen::ArrayXd squares = errors.col(c).array().square();
    double square = guess.size() > 0 ? guess(c) * guess(c) : squares.mean();
    const double least = smallest_scales(c) * smallest_scales(c);
    square = std::max(square, least);
    for (int i = 0; i < num_steps; ++i) {
      const double next = ((nu + 1.0) * squares / (nu + squares / square)).mean();
      const bool is_settled = std::abs(next - square) < 1e-4 * square;
      square = std::max(next, least);
      if (is_settled || square == least) break;
    }
    scales(c) = std::sqrt(square);
  }
  return scales;
}

double StudentErrors::cost(const RowMatrix& errors, const Vector& scales) const {
  if (!errors.allFinite()) return kInfinity;
  const double nu = degrees_of_freedom;
  double sum = 0.0;
  for (Index c = 0; c < errors.cols(); ++c) {
    const auto squares = (errors.col(c) / scales(c)).array().square();
    sum += static_cast<double>(errors.rows()) * std::log(scales(c));
    sum += 0.5 * (nu + 1.0) * (1.0 + squares / nu).log().sum();
  }
  return sum;
}

RowMatrix StudentErrors::weights(const RowMatrix& errors, const Vector& scales) const {
  const double nu = degrees_of_freedom;
  const RowMatrix z = errors * scales.cwiseInverse().asDiagonal();
  return (nu + 1.0) / (nu + z.array().square());
}

RowMatrix StudentErrors::scores(const RowMatrix& errors, const Vector& scales) const {
  const RowMatrix z = errors * scales.cwiseInverse().asDiagonal();
  return weights(errors, scales).cwiseProduct(z);
}

Vector StudentErrors::curvatures(const RowMatrix& errors, const Vector& scales) const {
  constexpr double least = 0.01;
  const double nu = degrees_of_freedom;
  const Eigen::ArrayXXd squares = (errors * scales.cwiseInverse().asDiagonal()).array().square();
  const Eigen::ArrayXXd slopes = (nu + 1.0) * (nu - squares) / (nu + squares).square();
  return slopes.colwise().mean().transpose().cwiseMax(least);
}

}  // namespace npdr::inference
