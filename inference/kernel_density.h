/// Density of weighted samples by Gaussian kernels.
///
/// Scott 1992, "Multivariate Density Estimation", section 6.3.2: every sample carries a Gaussian
/// with the samples' own covariance C, made narrower,
///   log p(x) = logsumexp_i [ log w_i + log N(x; x_i, h^2 C) ],     h = n_eff^(-1 / (d + 4)),
/// with the effective size of the weights in place of n. The kernel has the shape of the samples,
/// so that scales and linear correlations don't matter; separate modes are smoothed as widely as
/// one. Columns that don't vary are taken as known: the density is one of the d others.
#pragma once

#include <Eigen/Cholesky>
#include <vector>

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

class KernelDensity {
 public:
  /// points: (n, D); weights: (n), >= 0 with a sum > 0. Points that aren't finite are left out.
  /// Throws InputError when no column of the others varies.
  KernelDensity(const RowMatrix& points, const Vector& weights);

  /// (n) in nats; -infinity for a row that isn't finite. Parallel over rows, with the same bits on
  /// any number of threads.
  Vector log_prob(const RowMatrix& points) const;

  /// A draw of the kernel around 0, (D).
  Vector sample_kernel(Stream& stream) const;

 private:
  /// The columns that vary, with the kernel as N(0, I), a point a column: (d, n).
  Eigen::MatrixXd whitened(const RowMatrix& points) const;

  Index dimension_;
  std::vector<Index> columns_;  ///< (d) that vary
  Vector scale_;                ///< (d) their deviations
  Eigen::MatrixXd factor_;   ///< (d, d) lower: the kernel's covariance, of scaled columns, is L L^T
  double log_constant_;      ///< of the kernel's density
  Eigen::MatrixXd centers_;  ///< (d, n) whitened
  Vector log_weights_;       ///< (n) normalized
};

}  // namespace npdr::inference
