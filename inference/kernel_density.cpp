#include "inference/kernel_density.h"

#include <cmath>

#include "core/constants.h"
#include "core/decompositions.h"
#include "core/error.h"
#include "core/log_sum_exp.h"
#include "core/parallel.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
namespace {

constexpr double kSmallestVariance = 1e-9;  // of the kernel along any direction, over the largest
constexpr double kRounding = 1e-12;         // of a column that doesn't vary, over its largest value

std::vector<Index> finite_rows(const RowMatrix& points) {
  std::vector<Index> rows;
  for (Index i = 0; i < points.rows(); ++i) {
    if (points.row(i).allFinite()) rows.push_back(i);
  }
  return rows;
}

bool varies(const Eigen::Ref<const Vector>& column) {
  return column.maxCoeff() - column.minCoeff() > kRounding * column.cwiseAbs().maxCoeff();
}

}  // namespace

KernelDensity::KernelDensity(const RowMatrix& all, const Vector& all_weights)
    : dimension_(all.cols()) {
  const std::vector<Index> rows = finite_rows(all);
  const RowMatrix points = all(rows, Eigen::all);
  const Vector weights = all_weights(rows);
  for (Index d = 0; d < points.cols() && points.rows() > 0; ++d) {
    if (varies(points.col(d))) columns_.push_back(d);
  }
  if (columns_.empty()) {
    throw InputError("kernel density: no parameter of the " + std::to_string(points.rows()) +
                     " finite samples varies");
  }
  const RowMatrix varying = points(Eigen::all, columns_);
  const auto d = static_cast<Index>(columns_.size());
  const Eigen::MatrixXd covariance = weighted_covariance(varying, weights);
  scale_ = covariance.diagonal().cwiseSqrt();
  if (!(scale_.minCoeff() > 0.0)) {
    throw InputError("kernel density: one sample has all of the weight");
  }
  const Eigen::MatrixXd correlation =
      scale_.cwiseInverse().asDiagonal() * covariance * scale_.cwiseInverse().asDiagonal();
  const double bandwidth = std::pow(effective_size(weights), -1.0 / static_cast<double>(d + 4));
  factor_ = bandwidth *
            Cholesky(correlation + kSmallestVariance * Eigen::MatrixXd::Identity(d, d)).lower();
  log_constant_ = -0.5 * static_cast<double>(d) * kLogTwoPi -
                  factor_.diagonal().array().log().sum() - scale_.array().log().sum();
  centers_ = whitened(points);
  log_weights_ = (weights / weights.sum()).array().log();
}

Eigen::MatrixXd KernelDensity::whitened(const RowMatrix& points) const {
  Eigen::MatrixXd scaled =
      scale_.cwiseInverse().asDiagonal() * points(Eigen::all, columns_).transpose();
  return factor_.triangularView<Eigen::Lower>().solve(scaled);
}

Vector KernelDensity::log_prob(const RowMatrix& points) const {
  Vector result(points.rows());
  parallel_for(points.rows(), [&](Index i) {
    if (!points.row(i).allFinite()) {
      result(i) = -kInfinity;
      return;
    }
    const Vector at = whitened(points.row(i));
    const Vector squares = (centers_.colwise() - at).colwise().squaredNorm().transpose();
    result(i) = log_sum_exp(log_weights_ - 0.5 * squares) + log_constant_;
  });
  return result;
}

Vector KernelDensity::sample_kernel(Stream& stream) const {
  Vector z(scale_.size());
  for (double& value : z) value = stream.normal();
  const Vector moved = scale_.cwiseProduct(factor_.triangularView<Eigen::Lower>() * z);
  Vector step = Vector::Zero(dimension_);
  step(columns_) = moved;
  return step;
}

}  // namespace npdr::inference
