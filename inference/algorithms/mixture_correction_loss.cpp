#include "inference/algorithms/mixture_correction_loss.h"

#include <cmath>

#include "core/constants.h"
#include "core/log_sum_exp.h"

namespace npdr::inference {
namespace {

double log_det(const Eigen::MatrixXd& precision_factor) {
  return 2.0 * precision_factor.diagonal().array().log().sum();
}

std::size_t index(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

MixtureCorrection::MixtureCorrection(const GaussianMixture& proposal)
    : dimension_(proposal.dimension()) {
  const Index d = dimension_;
  factor_.resize(index(d * d));
  inverse_factor_.resize(index(d * d));
  blocks_.resize(index((proposal.num_components() + kLanes - 1) / kLanes));
  for (Block& block : blocks_) {
    block.log_constant.setConstant(-kInfinity);
    block.precision_minus_identity.assign(index(d * d), Lanes::Zero());
    block.precision_times_mean.assign(index(d), Lanes::Zero());
  }
  for (Index j = 0; j < proposal.num_components(); ++j) {
    Block& block = blocks_[index(j / kLanes)];
    const Index lane = j % kLanes;
    const Eigen::MatrixXd precision = proposal.precision(j);
    const Vector& mean = proposal.means[index(j)];
    const Vector product = precision * mean;
    block.log_constant(lane) =
        proposal.log_weights(j) +
        0.5 * (log_det(proposal.precision_factors[index(j)]) - mean.dot(product));
    for (Index row = 0; row < d; ++row) {
      block.precision_times_mean[index(row)](lane) = product(row);
      for (Index col = 0; col < d; ++col) {
        at(block.precision_minus_identity, row, col)(lane) =
            precision(row, col) - (row == col ? 1.0 : 0.0);
      }
    }
  }
}

MixtureCorrection::Lanes& MixtureCorrection::at(LaneArray& matrix, Index row, Index col) const {
  return matrix[index(row * dimension_ + col)];
}

double MixtureCorrection::log_normalizer(const GaussianMixture& q,
                                         GaussianMixtureGradient* gradient) {
  const Index num_blocks = static_cast<Index>(blocks_.size());
  products_.resize(index(q.num_components() * num_blocks));
  Vector log_masses(q.num_components() * num_blocks * kLanes);
  for (Index k = 0; k < q.num_components(); ++k) {
    const Eigen::MatrixXd precision = q.precision(k);
    const double log_constant = q.log_weights(k) + 0.5 * log_det(q.precision_factors[index(k)]);
    for (Index b = 0; b < num_blocks; ++b) {
      Product& product = products_[index(k * num_blocks + b)];
      multiply(q.precision_factors[index(k)], precision, q.means[index(k)], blocks_[index(b)],
               gradient != nullptr, product);
      product.log_mass += log_constant;
      log_masses.segment<kLanes>((k * num_blocks + b) * kLanes) = product.log_mass.matrix();
    }
  }
  const double log_z = log_sum_exp(log_masses);
  if (gradient == nullptr) return log_z;
  gradient->log_weights.resize(q.num_components());
  gradient->means.resize(index(q.num_components()));
  gradient->precision_factors.resize(index(q.num_components()));
  for (Index k = 0; k < q.num_components(); ++k) add_gradient(q, k, log_z, *gradient);
  return log_z;
}

// Cholesky's A = P + E = L L', E = P~ - I, then L^-1 and A^-1 = L^-T L^-1, for all lanes at once.
// With e = P~ m~ and g = e - E mu,
//   v = mu + A^-1 g,   exponent of the mass = (mu'(e + g) + g'A^-1 g) / 2,
// which is the same as v = A^-1 (P mu + e), (v'A v - mu'P mu) / 2, without the difference of two
// large numbers where P is nearly singular: where the proposal is the prior, e, E and g are 0.
// As A - P is positive semidefinite, no pivot of A is smaller than that of P = U'U, the square of
// U's: rounding makes it so where q is nearly flat and the proposal as wide as the prior.
void MixtureCorrection::multiply(const Eigen::MatrixXd& factor, const Eigen::MatrixXd& precision,
                                 const Vector& mean, const Block& block, bool with_covariance,
                                 Product& product) {
  const Index d = dimension_;
  product.log_mass = block.log_constant;
  product.mean.resize(index(d));
  gap_.resize(index(d));
  for (Index i = 0; i < d; ++i) {
    const Lanes& e = block.precision_times_mean[index(i)];
    Lanes& g = gap_[index(i)] = e;
    for (Index j = 0; j < d; ++j) g -= block.precision_minus_identity[index(i * d + j)] * mean(j);
    product.log_mass += 0.5 * mean(i) * (e + g);
    product.mean[index(i)].setConstant(mean(i));
  }
  for (Index i = 0; i < d; ++i) {
    for (Index j = 0; j <= i; ++j) {
      Lanes sum = block.precision_minus_identity[index(i * d + j)] + precision(i, j);
      for (Index l = 0; l < j; ++l) sum -= at(factor_, i, l) * at(factor_, j, l);
      if (j < i) {
        at(factor_, i, j) = sum * at(inverse_factor_, j, j);
      } else {
        sum = sum.max(factor(i, i) * factor(i, i));
        product.log_mass -= 0.5 * sum.log();
        at(inverse_factor_, i, i) = sum.rsqrt();
      }
    }
    for (Index j = 0; j < i; ++j) {
      Lanes sum = Lanes::Zero();
      for (Index l = j; l < i; ++l) sum -= at(factor_, i, l) * at(inverse_factor_, l, j);
      at(inverse_factor_, i, j) = sum * at(inverse_factor_, i, i);
    }
    Lanes y = Lanes::Zero();  // L^-1 g
    for (Index l = 0; l <= i; ++l) y += at(inverse_factor_, i, l) * gap_[index(l)];
    product.log_mass += 0.5 * y.square();
    for (Index l = 0; l <= i; ++l) product.mean[index(l)] += at(inverse_factor_, i, l) * y;
  }
  if (!with_covariance) return;
  product.covariance.assign(index(d * d), Lanes::Zero());
  for (Index l = 0; l < d; ++l) {
    for (Index i = 0; i <= l; ++i) {
      for (Index j = 0; j <= i; ++j) {
        at(product.covariance, i, j) += at(inverse_factor_, l, i) * at(inverse_factor_, l, j);
      }
    }
  }
}

// With the shares r_j = exp(log mass - log Z) and P = U'U:
//   dlogZ/dlog a = sum r,   dlogZ/dmu = P sum r (v - mu),
//   dlogZ/dU = upper triangle of U^-T sum r - U sum r (A^-1 + (v - mu)(v - mu)').
void MixtureCorrection::add_gradient(const GaussianMixture& q, Index k, double log_z,
                                     GaussianMixtureGradient& gradient) const {
  const Index d = dimension_;
  const Vector& mean = q.means[index(k)];
  const Eigen::MatrixXd& factor = q.precision_factors[index(k)];
  double total = 0.0;
  Vector gap = Vector::Zero(d);
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(d, d);  // lower triangle
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const Product& product = products_[index(k) * blocks_.size() + b];
    const Lanes share = (product.log_mass - log_z).exp();
    total += share.sum();
    for (Index i = 0; i < d; ++i) {
      const Lanes gap_i = share * (product.mean[index(i)] - mean(i));
      gap(i) += gap_i.sum();
      for (Index j = 0; j <= i; ++j) {
        spread(i, j) += (share * product.covariance[index(i * d + j)] +
                         gap_i * (product.mean[index(j)] - mean(j)))
                            .sum();
      }
    }
  }
  gradient.log_weights(k) = total;
  gradient.means[index(k)] = factor.transpose() * (factor * gap);
  Eigen::MatrixXd& d_factor = gradient.precision_factors[index(k)];
  d_factor = -(factor * spread.selfadjointView<Eigen::Lower>());
  d_factor.diagonal() += total * factor.diagonal().cwiseInverse();
  d_factor.triangularView<Eigen::StrictlyLower>().setZero();
}

}  // namespace npdr::inference
