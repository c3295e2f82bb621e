/// Decompositions of small dense matrices, compiled once for all who use them.
#pragma once

#include "core/types.h"

namespace npdr {

/// A = L L^T of a symmetric matrix A (n, n), of which the lower triangle is read. Const calls are
/// thread-safe.
class Cholesky {
 public:
  explicit Cholesky(const Eigen::MatrixXd& matrix);

  /// Whether there is an L; without one the other members mean nothing.
  bool is_positive_definite() const { return is_positive_definite_; }
  /// L (n, n), zero above the diagonal.
  const Eigen::MatrixXd& lower() const { return lower_; }
  /// L z, (n).
  Vector times(const Vector& z) const;
  /// L^-1 b, (n) or (n, m).
  Vector solve_lower(const Vector& b) const;
  Eigen::MatrixXd solve_lower(const Eigen::MatrixXd& b) const;
  /// A^-1 b, (n) or (n, m).
  Vector solve(const Vector& b) const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;
  /// A^-1, (n, n).
  Eigen::MatrixXd inverse() const;
  /// Sum of the logarithms of L's diagonal: half of log det A.
  double half_log_det() const;

 private:
  Eigen::MatrixXd lower_;
  bool is_positive_definite_;
};

/// A = V diag(values) V^T of a symmetric matrix A (n, n), of which the lower triangle is read.
struct SymmetricEigen {
  explicit SymmetricEigen(const Eigen::MatrixXd& matrix);

  Vector values;            ///< (n), ascending
  Eigen::MatrixXd vectors;  ///< V (n, n), a column each
  bool has_converged;       ///< else values and vectors mean nothing
};

/// argmin_X |A X - B| by Householder's QR decomposition, A (m, n) of full rank, m >= n: (n) or (n,
/// k).
Vector least_squares(const Eigen::MatrixXd& a, const Vector& b);
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace npdr
