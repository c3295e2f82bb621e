/// Simulation-based calibration: does a posterior have the right width?
///
/// Source: Talts, Betancourt, Simpson, Vehtari and Gelman 2018, "Validating Bayesian inference
/// algorithms with simulation-based calibration", algorithm 1. For theta* drawn from the prior,
/// x ~ p(x | theta*) and L samples of the posterior p(theta | x), the rank of theta*_d among the
/// samples is uniform on 0, ..., L when the posterior is right. Too narrow a posterior piles ranks
/// up at both ends, too wide a one in the middle, a biased one at one end.
#pragma once

#include <vector>

#include "core/types.h"

namespace npdr::analysis {

/// Per parameter d, how many of `samples` (L, D) are smaller than truth_d: (D), each in 0, ..., L.
/// Throws ShapeError when the widths differ.
std::vector<Index> ranks(const RowMatrix& samples, const Vector& truth);

/// Pearson's test that ranks are uniform.
struct UniformityTest {
  std::vector<Index> counts;  ///< (B) ranks that fall into each bin
  double chi_square = 0.0;    ///< sum_b (counts_b - n / B)^2 / (n / B)
  double p_value = 1.0;       ///< P(chi^2 with B - 1 degrees of freedom >= chi_square)
};

/// Tests n ranks on 0, ..., num_samples with `num_bins` bins of equal width. Throws InputError for
/// a rank out of range, no ranks, fewer than two bins, or bins that don't divide num_samples + 1.
UniformityTest test_uniform_ranks(const std::vector<Index>& ranks, Index num_samples,
                                  Index num_bins);

}  // namespace npdr::analysis
