#include "inference/estimators/gaussian_mixture.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/constants.h"
#include "core/decompositions.h"
#include "core/log_sum_exp.h"

namespace npdr::inference {

Eigen::MatrixXd GaussianMixture::precision(Index k) const {
  const Eigen::MatrixXd& factor = precision_factors[static_cast<std::size_t>(k)];
  return factor.transpose() * factor;
}

Vector GaussianMixture::log_prob(const RowMatrix& u) const {
  Vector result(u.rows());
  Vector terms(num_components());
  for (Index i = 0; i < u.rows(); ++i) {
    for (Index k = 0; k < num_components(); ++k) {
      const Eigen::MatrixXd& factor = precision_factors[static_cast<std::size_t>(k)];
      const Vector y = factor * (u.row(i).transpose() - means[static_cast<std::size_t>(k)]);
      terms(k) = log_weights(k) + factor.diagonal().array().log().sum() -
                 0.5 * (y.squaredNorm() + static_cast<double>(dimension()) * kLogTwoPi);
    }
    result(i) = log_sum_exp(terms);
  }
  return result;
}

RowMatrix GaussianMixture::sample(Index n, StreamId id) const {
  Vector cumulative = log_weights.array().exp();
  std::partial_sum(cumulative.begin(), cumulative.end(), cumulative.begin());
  RowMatrix u(n, dimension());
  Vector z(dimension());
  for (Index i = 0; i < n; ++i, ++id.row) {
    Stream stream(id);
    const double p = stream.uniform();
    const Index k = std::ranges::lower_bound(cumulative, p) - cumulative.begin();
    for (double& value : z) value = stream.normal();
    const auto component = static_cast<std::size_t>(std::min(k, num_components() - 1));
    precision_factors[component].triangularView<Eigen::Upper>().solveInPlace(z);
    u.row(i) = (means[component] + z).transpose();
  }
  return u;
}

Eigen::MatrixXd precision_factor(const Eigen::MatrixXd& covariance) {
  return Cholesky(Cholesky(covariance).inverse()).lower().transpose();
}

GaussianMixture narrower_than_prior(const GaussianMixture& mixture) {
  GaussianMixture narrow = mixture;
  for (Index k = 0; k < mixture.num_components(); ++k) {
    const SymmetricEigen eigen(mixture.precision(k));
    const Eigen::MatrixXd precision =
        eigen.vectors * eigen.values.cwiseMax(1.0).asDiagonal() * eigen.vectors.transpose();
    narrow.precision_factors[static_cast<std::size_t>(k)] = Cholesky(precision).lower().transpose();
  }
  return narrow;
}

namespace {

// Knowledge of a Gaussian N(mu, P^-1) beyond another one N(m, S^-1), along the eigenvectors of P -
// S: precisions, and shifts V' (P mu - S m). Directions in which it is wider than the other say
// nothing.
struct Surplus {
  Eigen::MatrixXd axes;
  Vector precision, shift;
};

Surplus surplus_of(const Eigen::MatrixXd& precision, const Vector& mean,
                   const Eigen::MatrixXd& other_precision, const Vector& other_mean) {
  const SymmetricEigen eigen(precision - other_precision);
  const Vector known = (eigen.values.array() > 0.0).cast<double>();
  const Vector shift =
      eigen.vectors.transpose() * (precision * mean - other_precision * other_mean);
  return {eigen.vectors, known.cwiseProduct(eigen.values), known.cwiseProduct(shift)};
}

}  // namespace

GaussianMixture corrected_for_proposal(const GaussianMixture& mixture,
                                       const GaussianMixture& proposal) {
  const Eigen::MatrixXd other = proposal.precision(0);
  const Vector& other_mean = proposal.means.front();
  GaussianMixture result = mixture;
  for (Index k = 0; k < mixture.num_components(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (mixture.log_weights(k) < std::log(kLeastDividedWeight)) {
      result.log_weights(k) = -kInfinity;
      continue;
    }
    const Surplus surplus = surplus_of(mixture.precision(k), mixture.means[i], other, other_mean);
    const auto sum_with = [&](const Eigen::MatrixXd& precision) -> Eigen::MatrixXd {
      return precision + surplus.axes * surplus.precision.asDiagonal() * surplus.axes.transpose();
    };
    const Vector shift = surplus.axes * surplus.shift;
    // The component, nowhere wider than the proposal, and what is left of it after the division.
    const Cholesky whole(sum_with(other));
    const Vector whole_shift = other * other_mean + shift;
    const Cholesky left(
        sum_with(Eigen::MatrixXd::Identity(mixture.dimension(), mixture.dimension())));
    result.means[i] = left.solve(shift);
    result.precision_factors[i] = left.lower().transpose();
    // log of the integral of N(whole) N(0, I) / N(m, S), but for what all components share.
    result.log_weights(k) +=
        0.5 * (2.0 * whole.half_log_det() - 2.0 * left.half_log_det() -
               whole_shift.dot(whole.solve(whole_shift)) + shift.dot(result.means[i]));
  }
  result.log_weights.array() -= log_sum_exp(result.log_weights);
  return result;
}

}  // namespace npdr::inference
