/// Bayesian linear regression, y = Phi w + e, with the precisions of weights and noise from the
/// data.
///
/// Sources: Bishop 2006, section 3.3 (eqs. 3.53-3.54); MacKay 1992, "Bayesian interpolation", for
/// the fixed point, which Tipping 2001, eqs. 16-18, has for one precision per weight. With
/// w ~ N(0, 1 / alpha I) and e ~ N(0, 1 / beta I),
///   p(w | y) = N(m, S),   S^-1 = alpha I + beta Phi^T Phi,   m = beta S Phi^T y,
/// and the evidence p(y | alpha, beta) has its maximum where
///   alpha = gamma / |m|^2,   beta = (N - gamma) / |y - Phi m|^2,
///   gamma = sum_i lambda_i / (lambda_i + alpha),  lambda_i the eigenvalues of beta Phi^T Phi.
#pragma once

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// Inverse variances of the weights and of the noise.
struct Precisions {
  double weights = 1.0;  ///< alpha
  double noise = 1.0;    ///< beta
};

/// Gaussian posterior of the weights.
struct WeightPosterior {
  Vector mean;                 ///< (W)
  Eigen::MatrixXd covariance;  ///< (W, W)
  Precisions precisions;

  /// (n, W). Sample i depends on `id` and i alone.
  RowMatrix sample(Index n, const StreamId& id) const;
};

/// The posterior for given precisions. phi: (N, W), y: (N). Throws ShapeError when they don't go
/// together.
WeightPosterior weight_posterior(const RowMatrix& phi, const Vector& y,
                                 const Precisions& precisions);

/// The posterior for the precisions of largest evidence. Weights have one precision when each
/// column of phi is scaled to a mean square of 1, so that units don't matter; `precisions.weights`
/// is that of the scaled ones. Throws InputError for fewer rows than W + 1, for y = 0, or where the
/// evidence has no maximum because phi tells nothing of y.
WeightPosterior maximize_evidence(const RowMatrix& phi, const Vector& y);

}  // namespace npdr::inference
