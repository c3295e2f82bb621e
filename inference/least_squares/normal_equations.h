/// Normal equations of least squares whose errors come in blocks with unknowns of their own.
///
/// Parameters u (D) move all errors, own unknowns b_s (C) those of block s alone; all have the
/// prior N(0, 1). With slopes U_s and V_s of the block's errors by u and b_s, weights W_s, and g_s
/// the derivatives of the cost by its errors, b_s is eliminated (variable projection; Golub and
/// Pereyra 2003):
///   M_s = V_s^T W_s V_s + I,   X_s = M_s^-1 V_s^T W_s U_s,   r_s = M_s^-1 (V_s^T g_s + b_s),
///   A = sum_s (U_s^T W_s U_s - X_s^T M_s X_s),   g = sum_s (U_s^T g_s - X_s^T M_s r_s) + u,
/// and a step du of u goes with db_s = -r_s - X_s du.
/// Private to inference/least_squares.
#pragma once

#include <vector>

#include "core/types.h"

namespace npdr::inference {

/// Errors of H rollouts of K steps of C channels, and what the cost says of them.
struct WeightedErrors {
  RowMatrix slopes;     ///< (H K C, D + C) by u, and by the own unknowns of the error's block
  RowMatrix weights;    ///< (H K, C) curvature of the cost by each error
  RowMatrix gradients;  ///< (H K, C) derivative of the cost by each error
};

class NormalEquations {
 public:
  NormalEquations() = default;
  /// `unknowns`: (D + B C), u and b_1, ..., b_B. `begins`: the steps of a rollout that blocks begin
  /// with; none: there are no blocks, and slopes have D columns.
  NormalEquations(const WeightedErrors& errors, const Vector& unknowns,
                  const std::vector<Index>& begins, Index num_rollouts);

  /// A, (D, D): without the prior of u.
  const RowMatrix& curvature() const { return curvature_; }
  /// [nats] that the undamped step takes away, were errors linear.
  double promised() const;
  /// The step (D + B C) with the diagonal of A + I times 1 + damping, and r_s over it, where no
  /// step of u is longer than `longest`.
  Vector step(double damping, double longest) const;
  /// Derivatives of the cost by u at each step, (H K, D), with b_s following u, and its prior's at
  /// the first step of block s.
  RowMatrix scores_of_steps(const WeightedErrors& errors) const;

 private:
  struct Block {
    Index begin = 0, count = 0;  // rows (H K) of errors
    Vector own;                  // b_s
    RowMatrix follows;           // X_s, (C, D)
    Vector rest;                 // r_s
  };

  RowMatrix curvature_;
  Vector gradient_;      // g
  double own_gain_ = 0;  // sum_s r_s^T M_s r_s
  std::vector<Block> blocks_;
};

/// curvature + I: with that of the prior.
RowMatrix with_prior(RowMatrix curvature);

}  // namespace npdr::inference
