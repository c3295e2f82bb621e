#include "inference/abc/step_kernel.h"

#include <cmath>
#include <string>

#include "core/constants.h"
#include "core/decompositions.h"
#include "core/error.h"

namespace npdr::inference {

StepKernel::StepKernel(const Eigen::MatrixXd& covariance, Index dimension) {
  if (covariance.rows() != dimension || covariance.cols() != dimension) {
    throw InputError("ABC: the population has no kernel of " + std::to_string(dimension) +
                     " parameters to propose with; rerun stage 'infer'");
  }
  const Cholesky cholesky(covariance);
  factor_ = cholesky.lower();
  if (cholesky.is_positive_definite() && factor_.diagonal().minCoeff() > 0.0) return;
  throw Error(
      "ABC: the accepted simulations span fewer dimensions than there are parameters; raise "
      "abc.quantile, abc.epsilon or num_simulations");
}

Vector StepKernel::sample(Stream& stream) const {
  Vector z(factor_.cols());
  for (double& value : z) value = stream.normal();
  return factor_.triangularView<Eigen::Lower>() * z;
}

Vector StepKernel::log_density(const RowMatrix& steps) const {
  const Eigen::MatrixXd z = factor_.triangularView<Eigen::Lower>().solve(steps.transpose());
  const double constant =
      -0.5 * static_cast<double>(steps.cols()) * kLogTwoPi - factor_.diagonal().array().log().sum();
  return (-0.5 * z.colwise().squaredNorm().transpose()).array() + constant;
}

}  // namespace npdr::inference
