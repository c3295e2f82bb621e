#include "inference/estimators/gaussian_mixture.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

namespace npdr::inference {

Eigen::MatrixXd GaussianMixture::precision(Index k) const {
  const Eigen::MatrixXd& factor = precision_factors[static_cast<std::size_t>(k)];
  return factor.transpose() * factor;
}

Vector GaussianMixture::log_prob(const RowMatrix& u) const {
  const double log_two_pi = std::log(2.0 * std::numbers::pi);
  Vector result(u.rows());
  Vector terms(num_components());
  for (Index i = 0; i < u.rows(); ++i) {
    for (Index k = 0; k < num_components(); ++k) {
      const Eigen::MatrixXd& factor = precision_factors[static_cast<std::size_t>(k)];
      const Vector y = factor * (u.row(i).transpose() - means[static_cast<std::size_t>(k)]);
      terms(k) = log_weights(k) + factor.diagonal().array().log().sum() -
                 0.5 * (y.squaredNorm() + static_cast<double>(dimension()) * log_two_pi);
    }
    result(i) = log_sum_exp(terms);
  }
  return result;
}

Vector GaussianMixture::sample(Stream& stream) const {
  const double p = stream.uniform();
  Index k = 0;
  double cumulative = std::exp(log_weights(0));
  while (cumulative < p && k + 1 < num_components()) cumulative += std::exp(log_weights(++k));
  Vector z(dimension());
  for (double& value : z) value = stream.normal();
  const auto i = static_cast<std::size_t>(k);
  return means[i] + precision_factors[i].triangularView<Eigen::Upper>().solve(z);
}

GaussianMixture narrower_than_prior(const GaussianMixture& mixture) {
  GaussianMixture narrow = mixture;
  for (Index k = 0; k < mixture.num_components(); ++k) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(mixture.precision(k));
    const Eigen::MatrixXd precision = eigen.eigenvectors() *
                                      eigen.eigenvalues().cwiseMax(1.0).asDiagonal() *
                                      eigen.eigenvectors().transpose();
    narrow.precision_factors[static_cast<std::size_t>(k)] = precision.llt().matrixU();
  }
  return narrow;
}

double log_sum_exp(const Vector& values) {
  const double largest = values.maxCoeff();
  if (!std::isfinite(largest)) return largest;
  return largest + std::log((values.array() - largest).exp().sum());
}

}  // namespace npdr::inference
