/// Checks that every conditional density estimator must pass.
#pragma once

#include "inference/estimators/density_estimator.h"
#include "tests/inference/cells.h"
#include "tests/inference/gradient_check.h"

namespace npdr::inference {

/// Random weights well away from the initial near-identity, so that every path matters.
inline Vector random_parameters(const DensityEstimator<double>& estimator, Index size,
                                std::uint64_t seed) {
  Vector parameters = Vector::Zero(size);
  Stream stream({seed, "initial", 0, 0, 0});
  estimator.initialize(parameters, stream);
  // Masked weights, and nothing else, are zero, and stay so.
  for (double& p : parameters) p *= 1.0 + 0.3 * stream.normal();
  return parameters;
}

/// d/dparameters and d/dcontext of sum_i w_i log q(u_i | c) against central differences, for n
/// contexts with k values of u each.
inline void expect_gradients_of(const DensityEstimator<double>& estimator, Index num_parameters,
                                Index n, Index k) {
  const Vector parameters = random_parameters(estimator, num_parameters, 3);
  const RowMatrix u = random_matrix(n * k, estimator.dimension(), 4);
  const RowMatrix context = random_matrix(n, estimator.context_features(), 5);
  const Vector weights = random_matrix(n * k, 1, 6).col(0);
  const auto scratch = estimator.make_scratch();
  const auto objective = [&](const Vector& p, const RowMatrix& c) {
    Vector log_prob;
    estimator.log_prob(p, u, c, *scratch, log_prob);
    return weights.dot(log_prob);
  };
  objective(parameters, context);
  Vector gradient = Vector::Zero(num_parameters);
  RowMatrix d_context;
  estimator.backward(parameters, u, context, weights, *scratch, gradient, &d_context);
  expect_gradient(
      [&](const Vector& p) {
        return objective((parameters.array() == 0.0).select(0.0, p), context);
      },
      parameters, gradient);
  const Vector flat_context = Eigen::Map<const Vector>(context.data(), context.size());
  const Vector flat_gradient = Eigen::Map<const Vector>(d_context.data(), d_context.size());
  expect_gradient(
      [&](const Vector& c) {
        return objective(parameters,
                         Eigen::Map<const RowMatrix>(c.data(), context.rows(), context.cols()));
      },
      flat_context, flat_gradient);
}

/// Integral of q(. | c) over a grid on [-12, 12]^2.
inline double mass_on_a_grid(const DensityEstimator<double>& estimator, const Vector& parameters) {
  constexpr Index side = 600;
  constexpr double width = 24.0 / side;
  const RowMatrix u = cells_of({-12.0, -12.0}, {12.0, 12.0}, side);
  const auto scratch = estimator.make_scratch();
  Vector log_prob;
  estimator.log_prob(parameters, u, random_matrix(1, estimator.context_features(), 8), *scratch,
                     log_prob);
  return log_prob.array().exp().sum() * width * width;
}

}  // namespace npdr::inference
