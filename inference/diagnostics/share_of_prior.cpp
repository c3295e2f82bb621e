#include "inference/diagnostics/share_of_prior.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/constants.h"
#include "core/decompositions.h"

namespace npdr::inference {
namespace {

constexpr Index kDraws = 10'000;
constexpr double kShareOfSamples = 0.99;

Vector squared_lengths(const RowMatrix& rows) { return rows.rowwise().squaredNorm(); }

// log of the volume of a ball in D dimensions.
double log_volume(double dimension, double radius) {
  return 0.5 * dimension * std::log(std::numbers::pi) - std::lgamma(0.5 * dimension + 1.0) +
         dimension * std::log(radius);
}

// Rows of N(0, I), of which the second half is moved to where it is uniform in the ball.
RowMatrix draws_around(Index dimension, double radius, const StreamId& id) {
  RowMatrix z(kDraws, dimension);
  Stream stream(id);
  for (double& value : z.reshaped<Eigen::RowMajor>()) value = stream.normal();
  for (Index i = kDraws / 2; i < kDraws; ++i) {
    z.row(i) *=
        radius * std::pow(stream.uniform(), 1.0 / static_cast<double>(dimension)) / z.row(i).norm();
  }
  return z;
}

}  // namespace

double share_of_prior(const RowMatrix& samples, const StreamId& id) {
  const Eigen::RowVectorXd mean = samples.colwise().mean();
  const RowMatrix centered = samples.rowwise() - mean;
  const Cholesky root(centered.transpose() * centered / static_cast<double>(centered.rows()));
  if (!root.is_positive_definite()) return 1.0;
  const Eigen::MatrixXd& lower = root.lower();
  Vector own = squared_lengths(root.solve_lower(Eigen::MatrixXd(centered.transpose())).transpose());
  std::sort(own.begin(), own.end());
  const double squared_radius =
      own(static_cast<Index>(kShareOfSamples * static_cast<double>(own.size() - 1)));
  const auto d = static_cast<double>(samples.cols());
  const double radius = std::sqrt(squared_radius);

  // All densities over (2 pi)^(-D/2).
  const RowMatrix z = draws_around(samples.cols(), radius, id);
  const Vector length = squared_lengths(z);
  const Vector of_prior = squared_lengths((z * lower.transpose()).rowwise() + mean);
  const double log_uniform = 0.5 * d * kLogTwoPi - log_volume(d, radius);
  const Eigen::ArrayXd q = 0.5 * (-0.5 * length.array()).exp() + 0.5 * std::exp(log_uniform);
  const double log_det = lower.diagonal().array().log().sum();
  const Eigen::ArrayXd weight = (log_det - 0.5 * of_prior.array()).exp() / q;
  return std::min((length.array() <= squared_radius).select(weight, 0.0).mean(), 1.0);
}

}  // namespace npdr::inference
