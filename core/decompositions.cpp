#include "core/decompositions.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace npdr {

Cholesky::Cholesky(const Eigen::MatrixXd& matrix) {
  const Eigen::LLT<Eigen::MatrixXd> llt(matrix);
  lower_ = llt.matrixL();
  is_positive_definite_ = llt.info() == Eigen::Success;
}

Vector Cholesky::times(const Vector& z) const { return lower_.triangularView<Eigen::Lower>() * z; }

Vector Cholesky::solve_lower(const Vector& b) const {
  return lower_.triangularView<Eigen::Lower>().solve(b);
}
Eigen::MatrixXd Cholesky::solve_lower(const Eigen::MatrixXd& b) const {
  return lower_.triangularView<Eigen::Lower>().solve(b);
}

Vector Cholesky::solve(const Vector& b) const {
  return lower_.transpose().triangularView<Eigen::Upper>().solve(solve_lower(b));
}
Eigen::MatrixXd Cholesky::solve(const Eigen::MatrixXd& b) const {
  return lower_.transpose().triangularView<Eigen::Upper>().solve(solve_lower(b));
}

Eigen::MatrixXd Cholesky::inverse() const {
  return solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(lower_.rows(), lower_.cols())));
}

double Cholesky::half_log_det() const { return lower_.diagonal().array().log().sum(); }

SymmetricEigen::SymmetricEigen(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
  values = eigen.eigenvalues();
  vectors = eigen.eigenvectors();
  has_converged = eigen.info() == Eigen::Success;
}

Vector least_squares(const Eigen::MatrixXd& a, const Vector& b) {
  return a.householderQr().solve(b);
}
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.householderQr().solve(b);
}

}  // namespace npdr
