/// Robust nonlinear least squares from many starts, with a posterior by curvature.
///
/// The cost over u, where the prior is N(0, I), is that of student_errors.h plus |u|^2 / 2. Steps
/// are those of Levenberg and Marquardt (Nocedal and Wright 2006, ch. 10.3) with the weights of
/// Student's t; derivatives are forward differences. All starts step together, so that each batch
/// of simulations is large. Starts that meet become one. After 6 and 12 steps the worse half of the
/// starts is given up.
///
/// Rollouts, or segments of them, may begin in states that were measured with noise, too: unknowns
/// of their own, with priors N(0, 1), that are eliminated from each step (normal_equations.h).
///
/// Errors of a simulator that lacks something last for many steps. So the covariance of a minimum
/// is that of an estimate by estimating equations (Huber 1967): with A the curvature of the cost
/// without the prior, by central differences, g_t the scores of step t and B = Cov(sum g_t)
/// (long_run_covariance.h), the data have the precision P = A B^-1 A, and the posterior is
///   N(u_min, (I + P)^-1).
/// Simulations are rounded to float, which looks like information: P counts only where A is well
/// above the curvature R that rounding alone would have. With A v = lambda R v, a direction v keeps
/// the share max(0, 1 - 10 / lambda).
/// Several minima are a mixture by their Laplace approximations, whose costs count to the power
/// tr(A) / tr(B), in coordinates where A + I is I (Pauli, Racugno and Ventura 2011).
#pragma once

#include <functional>
#include <vector>

#include "core/random.h"
#include "core/types.h"
#include "inference/least_squares/student_errors.h"

namespace npdr::inference {

/// Errors of rows of unknowns (n, D + B C) as rows (n, H K C): H rollouts of K steps of C channels.
/// The unknowns are u and, where rollouts are cut into blocks, C of each of the B blocks of all
/// rollouts. A row that isn't finite is one that couldn't be simulated.
using ErrorsOf = std::function<RowMatrixF(const RowMatrix& unknowns)>;

struct LeastSquaresConfig {
  Index num_candidates = 500;  ///< draws of the prior that starts are chosen from
  Index num_starts = 8;
  Index max_simulations = 20'000;
  Index max_steps = 200;  ///< of each start
};

struct LeastSquaresProblem {
  const ErrorsOf& errors;
  Index num_rollouts = 1;  ///< H
  StudentErrors noise;     ///< of C channels
  Vector rounding = {};    ///< (C) deviation of errors by rounding of simulations; empty: none
  /// Steps of a rollout that blocks begin with, whose first states are unknown; empty: no blocks.
  std::vector<Index> block_begins = {};
};

/// A local minimum of the cost.
struct Minimum {
  Vector u;                   ///< (D)
  double cost = 0.0;          ///< [nats]
  Vector scales;              ///< (C) of the errors
  RowMatrix covariance = {};  ///< (D, D)
  double weight = 0.0;        ///< share of the mixture
  Vector own = {};            ///< (B C) unknowns of blocks
};

struct LeastSquaresFit {
  std::vector<Minimum> minima;  ///< the best first; none: no start could be simulated
  Index num_rows = 0;           ///< simulated
  Index num_failed = 0;         ///< of these
  bool converged = false;       ///< the best minimum's steps ended by themselves

  /// (n, D) draws of the mixture. Draw i depends on `id` and i alone.
  RowMatrix sample(Index n, const StreamId& id) const;
};

/// The minima that the best of `candidates` (n, D) and `starts` (k, D) lead to. Then draws of the
/// posterior, twice as wide, are the candidates, as long as these lead to a minimum that is better
/// by a nat or more, in at most `max_rounds` rounds; 0: minima have neither covariance nor weight.
/// Where `max_simulations` aren't enough for all, half of them at most are candidates, and fewer
/// starts go on; one is looked at in any case. Throws what `errors` throws.
LeastSquaresFit least_squares(const LeastSquaresProblem& problem, const RowMatrix& candidates,
                              const RowMatrix& starts, const LeastSquaresConfig& config,
                              Index max_rounds, const StreamId& id);

/// The minima's u, (k, D).
RowMatrix minima_of(const LeastSquaresFit& fit);

}  // namespace npdr::inference
