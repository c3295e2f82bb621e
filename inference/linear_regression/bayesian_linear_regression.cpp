#include "inference/linear_regression/bayesian_linear_regression.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/decompositions.h"
#include "core/error.h"

namespace npdr::inference {
namespace {

constexpr int kMostIterations = 1000;
constexpr double kTolerance = 1e-9;          // of the precisions, relative
constexpr double kFewestWeights = 1e-6;      // that the data tell, gamma: fewer are none
constexpr double kSmallestResidual = 1e-28;  // over |y|^2: the rounding of 1e-14 of y

void check_shapes(const RowMatrix& phi, const Vector& y) {
  if (phi.rows() == y.size() && phi.cols() > 0) return;
  throw ShapeError("linear regression: " + std::to_string(phi.rows()) + " rows of " +
                   std::to_string(phi.cols()) + " regressors for " + std::to_string(y.size()) +
                   " responses");
}

[[noreturn]] void fail_without_evidence() {
  throw InputError(
      "linear regression: the regressors tell nothing of the response; the evidence is largest "
      "where "
      "all weights are 0");
}

// One step of the fixed point. `eigenvalues`: of phi^T phi.
Precisions next_precisions(const RowMatrix& phi, const Vector& y, const Vector& eigenvalues,
                           const WeightPosterior& now) {
  const Eigen::ArrayXd lambda = now.precisions.noise * eigenvalues.array();
  const double gamma = (lambda / (lambda + now.precisions.weights)).sum();
  if (!(gamma > kFewestWeights)) fail_without_evidence();
  // Without noise nothing but rounding is left, and the precision would grow for ever.
  const double residual =
      std::max((y - phi * now.mean).squaredNorm(), kSmallestResidual * y.squaredNorm());
  return {gamma / now.mean.squaredNorm(), (static_cast<double>(y.size()) - gamma) / residual};
}

bool differ(double a, double b) { return std::abs(a - b) > kTolerance * std::abs(b); }

WeightPosterior fixed_point(const RowMatrix& phi, const Vector& y) {
  const Vector eigenvalues = SymmetricEigen(phi.transpose() * phi).values.cwiseMax(0.0);
  WeightPosterior posterior =
      weight_posterior(phi, y, {1.0, static_cast<double>(y.size()) / y.squaredNorm()});
  for (int i = 0; i < kMostIterations; ++i) {
    const Precisions next = next_precisions(phi, y, eigenvalues, posterior);
    const bool is_done = !differ(next.weights, posterior.precisions.weights) &&
                         !differ(next.noise, posterior.precisions.noise);
    posterior = weight_posterior(phi, y, next);
    if (is_done) return posterior;
  }
  fail_without_evidence();  // the precision of the weights still grows
}

}  // namespace

RowMatrix WeightPosterior::sample(Index n, const StreamId& id) const {
  // S = L D L^T, which holds for a weight without any uncertainty, too.
  const Eigen::LDLT<Eigen::MatrixXd> factors(covariance);
  const Vector deviations = factors.vectorD().cwiseMax(0.0).cwiseSqrt();
  RowMatrix samples(n, mean.size());
  StreamId row = id;
  for (Index i = 0; i < n; ++i, ++row.row) {
    Stream stream(row);
    Vector z(mean.size());
    for (double& value : z) value = stream.normal();
    z = factors.matrixL() * z.cwiseProduct(deviations);
    samples.row(i) = (mean + factors.transpositionsP().transpose() * z).transpose();
  }
  return samples;
}

WeightPosterior weight_posterior(const RowMatrix& phi, const Vector& y,
                                 const Precisions& precisions) {
  check_shapes(phi, y);
  const Eigen::MatrixXd precision =
      precisions.weights * Eigen::MatrixXd::Identity(phi.cols(), phi.cols()) +
      precisions.noise * (phi.transpose() * phi);
  const Cholesky factor(precision);
  return {precisions.noise * factor.solve(Vector(phi.transpose() * y)), factor.inverse(),
          precisions};
}

WeightPosterior maximize_evidence(const RowMatrix& phi, const Vector& y) {
  check_shapes(phi, y);
  if (phi.rows() <= phi.cols()) {
    throw InputError("linear regression: " + std::to_string(phi.rows()) + " rows, must be > " +
                     std::to_string(phi.cols()) + ", the number of weights");
  }
  if (!(y.squaredNorm() > 0.0)) {
    throw InputError("linear regression: the response is 0 throughout, so it tells nothing");
  }
  Vector scale = (phi.colwise().squaredNorm() / static_cast<double>(phi.rows())).cwiseSqrt();
  scale = (scale.array() > 0.0).select(scale, 1.0);
  WeightPosterior posterior = fixed_point(phi * scale.cwiseInverse().asDiagonal(), y);
  posterior.mean = posterior.mean.cwiseQuotient(scale);
  posterior.covariance =
      scale.cwiseInverse().asDiagonal() * posterior.covariance * scale.cwiseInverse().asDiagonal();
  return posterior;
}

}  // namespace npdr::inference
