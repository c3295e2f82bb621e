/// The exact posterior of the linear-Gaussian task, and wrong ones.
#pragma once

#include <Eigen/Cholesky>

#include "inference/diagnostics/calibration.h"
#include "tests/inference/tasks.h"

namespace npdr::inference {

/// Faults of a wrong one.
struct Fault {
  double width = 1.0;  ///< times the right deviation
  double shift = 0.0;  ///< of the mean, in right deviations of each parameter
};

class GaussianPosterior : public Posterior {
 public:
  GaussianPosterior(const LinearGaussian& task, const VectorF& x, const Fault& fault)
      : prior_(task.prior()),
        factor_(Eigen::MatrixXd(task.covariance().llt().matrixL()) * fault.width),
        mean_(task.mean(x) + fault.shift * task.covariance().diagonal().cwiseSqrt()) {}

  const Prior& prior() const override { return prior_; }
  Samples draw(Index n, const StreamId& id) const override {
    RowMatrix theta(n, mean_.size());
    for (Index i = 0; i < n; ++i) {
      StreamId row = id;
      row.row += static_cast<std::uint64_t>(i);
      Stream stream(row);
      const Vector z = Vector::NullaryExpr(mean_.size(), [&](Index) { return stream.normal(); });
      theta.row(i) = (mean_ + factor_ * z).transpose();
    }
    return {theta};
  }
  Vector log_prob(const RowMatrix& theta) const override {
    const RowMatrix centered = theta.rowwise() - mean_.transpose();
    const auto triangle = factor_.triangularView<Eigen::Lower>();
    const double log_peak = -factor_.diagonal().array().log().sum() -
                            0.5 * static_cast<double>(mean_.size()) * std::log(2.0 * M_PI);
    return log_peak -
           0.5 * triangle.solve(centered.transpose()).colwise().squaredNorm().transpose().array();
  }

 private:
  Prior prior_;
  Eigen::MatrixXd factor_;
  Vector mean_;
};

inline AmortizedPosterior amortized(const LinearGaussian& task, const Fault& fault = {}) {
  return [task, fault](const VectorF& x) {
    return std::make_unique<GaussianPosterior>(task, x, fault);
  };
}

}  // namespace npdr::inference
