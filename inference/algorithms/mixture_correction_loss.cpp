#include "inference/algorithms/mixture_correction_loss.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace npdr::inference {
namespace {

// One pair (k, j): g, the mean v of the product and the inverse of its precision A.
struct Product {
  double log_mass = 0.0;
  Vector mean;
  Eigen::MatrixXd covariance;
};

Product multiply(const Eigen::MatrixXd& precision_q, const Vector& mean_q,
                 const Eigen::MatrixXd& precision_p, const Vector& mean_p, double log_det_q,
                 double log_det_p) {
  const Index d = mean_q.size();
  const Eigen::MatrixXd a = precision_q + precision_p - Eigen::MatrixXd::Identity(d, d);
  const Eigen::LLT<Eigen::MatrixXd> llt(a);
  const Vector b = precision_q * mean_q + precision_p * mean_p;
  Product product;
  product.mean = llt.solve(b);
  product.covariance = llt.solve(Eigen::MatrixXd::Identity(d, d));
  const Eigen::MatrixXd factor = llt.matrixL();
  const double log_det_a = 2.0 * factor.diagonal().array().log().sum();
  product.log_mass = 0.5 * (log_det_q + log_det_p - log_det_a - mean_q.dot(precision_q * mean_q) -
                            mean_p.dot(precision_p * mean_p) + b.dot(product.mean));
  return product;
}

double log_det(const Eigen::MatrixXd& factor) {
  return 2.0 * factor.diagonal().array().log().sum();
}

GaussianMixtureGradient zero_gradient(const GaussianMixture& q) {
  GaussianMixtureGradient gradient;
  const Index d = q.dimension();
  gradient.log_weights = Vector::Zero(q.num_components());
  gradient.means.assign(static_cast<std::size_t>(q.num_components()), Vector::Zero(d));
  gradient.precision_factors.assign(static_cast<std::size_t>(q.num_components()),
                                    Eigen::MatrixXd::Zero(d, d));
  return gradient;
}

}  // namespace

double log_normaliser(const GaussianMixture& q, const GaussianMixture& proposal,
                      GaussianMixtureGradient& gradient) {
  const Index num_q = q.num_components();
  const Index num_p = proposal.num_components();
  std::vector<Product> products;
  Vector terms(num_q * num_p);
  for (Index k = 0; k < num_q; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const Eigen::MatrixXd precision = q.precision(k);
    for (Index j = 0; j < num_p; ++j) {
      const auto l = static_cast<std::size_t>(j);
      products.push_back(multiply(precision, q.means[i], proposal.precision(j), proposal.means[l],
                                  log_det(q.precision_factors[i]),
                                  log_det(proposal.precision_factors[l])));
      terms(k * num_p + j) = q.log_weights(k) + proposal.log_weights(j) + products.back().log_mass;
    }
  }
  const double log_z = log_sum_exp(terms);

  gradient = zero_gradient(q);
  for (Index k = 0; k < num_q; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const Eigen::MatrixXd precision = q.precision(k);
    const Eigen::MatrixXd inverse_factor =
        q.precision_factors[i].triangularView<Eigen::Upper>().solve(
            Eigen::MatrixXd::Identity(q.dimension(), q.dimension()));
    const Eigen::MatrixXd covariance = inverse_factor * inverse_factor.transpose();
    // dg/dmu = P (v - mu);  dg/dP = (P^-1 - A^-1 - (mu - v)(mu - v)') / 2;  dP = dU'U + U'dU.
    Eigen::MatrixXd d_precision = Eigen::MatrixXd::Zero(q.dimension(), q.dimension());
    for (Index j = 0; j < num_p; ++j) {
      const Product& product = products[static_cast<std::size_t>(k * num_p + j)];
      const double share = std::exp(terms(k * num_p + j) - log_z);
      const Vector gap = product.mean - q.means[i];
      gradient.log_weights(k) += share;
      gradient.means[i] += share * (precision * gap);
      d_precision += share * 0.5 * (covariance - product.covariance - gap * gap.transpose());
    }
    gradient.precision_factors[i] = 2.0 * q.precision_factors[i] * d_precision;
    gradient.precision_factors[i].triangularView<Eigen::StrictlyLower>().setZero();
  }
  return log_z;
}

}  // namespace npdr::inference
