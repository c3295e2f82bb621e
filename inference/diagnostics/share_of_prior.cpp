#include "inference/diagnostics/share_of_prior.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace npdr::inference {
namespace {

constexpr Index kDraws = 10'000;
constexpr double kShareOfSamples = 0.99;

RowMatrix standard_normal(Index n, Index dimension, const StreamId& id) {
  RowMatrix draws(n, dimension);
  Stream stream(id);
  for (double& value : draws.reshaped<Eigen::RowMajor>()) value = stream.normal();
  return draws;
}

Vector squared_lengths(const RowMatrix& rows) { return rows.rowwise().squaredNorm(); }

}  // namespace

double share_of_prior(const RowMatrix& samples, const StreamId& id) {
  const Eigen::RowVectorXd mean = samples.colwise().mean();
  const RowMatrix centered = samples.rowwise() - mean;
  const Eigen::LLT<Eigen::MatrixXd> root(centered.transpose() * centered /
                                         static_cast<double>(centered.rows()));
  if (root.info() != Eigen::Success) return 1.0;
  const Eigen::MatrixXd lower = root.matrixL();
  Vector own = squared_lengths(root.matrixL().solve(centered.transpose()).transpose());
  std::sort(own.begin(), own.end());
  const double farthest =
      own(static_cast<Index>(kShareOfSamples * static_cast<double>(own.size() - 1)));

  const RowMatrix z = standard_normal(kDraws, samples.cols(), id);
  const RowMatrix u = (z * lower.transpose()).rowwise() + mean;
  const Vector length = squared_lengths(z);
  const Eigen::ArrayXd log_weight =
      0.5 * (length - squared_lengths(u)).array() + lower.diagonal().array().log().sum();
  const double share = (length.array() <= farthest).select(log_weight.exp(), 0.0).mean();
  return std::min(share, 1.0);
}

}  // namespace npdr::inference
