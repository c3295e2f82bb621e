/// Simulation-based calibration: does a posterior have the right place and width, parameter by
/// parameter?
///
/// Source: Talts, Betancourt, Simpson, Vehtari and Gelman 2018, "Validating Bayesian inference
/// algorithms with simulation-based calibration", algorithm 1. For theta* drawn from the prior,
/// x ~ p(x | theta*) and L samples of the posterior p(theta | x), the rank of theta*_d among the
/// samples is uniform on 0, ..., L when the posterior is right. Too narrow a posterior piles ranks
/// up at both ends, too wide a one in the middle, a biased one at one end.
#pragma once

#include <vector>

#include "inference/diagnostics/uniformity.h"

namespace npdr::inference {

/// Numbers of `samples` (L, D) that are smaller than truth_d, per parameter d: (D), each in 0, ...,
/// L. Of samples that are the same as truth_d, each number counts as smaller with equal chance.
/// Throws ShapeError when the widths differ.
std::vector<Index> ranks(const RowMatrix& samples, const Vector& truth);

/// Tests of the uniformity of ranks, parameter by parameter, and of all together.
struct Sbc {
  std::vector<KolmogorovSmirnov> kolmogorov_smirnov;  ///< (D)
  std::vector<ChiSquare> chi_square;                  ///< (D)
  /// (D), of the smaller p-value of the two: P of one as small when both are of uniform ranks.
  Vector parameter_p_value;
  double p_value = 1.0;  ///< of the smallest of them
};

/// Tests `spread` (n, D), the ranks of n truths as spread_ranks() gives them. Bins: 20, or fewer
/// such that 15 ranks are expected in each, or 2. Throws InputError for none.
Sbc test_sbc(const RowMatrix& spread);

}  // namespace npdr::inference
