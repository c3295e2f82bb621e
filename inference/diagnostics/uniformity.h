/// Tests that numbers are uniform on (0, 1).
#pragma once

#include <vector>

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// Kolmogorov-Smirnov: the largest distance between the empirical distribution function and the
/// diagonal. Sees a shift best.
struct KolmogorovSmirnov {
  double statistic = 0.0;
  double p_value = 1.0;  ///< Stephens 1970's approximation, good to 1 % for n >= 5
};

/// Pearson's chi-square over bins of equal width. Sees a wrong width (a U or an arch) best.
struct ChiSquare {
  std::vector<Index> counts;  ///< (B) values in each bin
  double statistic = 0.0;     ///< sum_b (counts_b - n / B)^2 / (n / B)
  double p_value = 1.0;       ///< P(chi^2 with B - 1 degrees of freedom >= statistic)
};

/// P(Kolmogorov and Smirnov's statistic of n >= 1 uniform draws is as large), by the approximation
/// of KolmogorovSmirnov::p_value.
double kolmogorov_smirnov_p_value(double statistic, Index n);

/// A^2 = -n - sum_i (2 i - 1) / n [log f_i + log(1 - f_(n + 1 - i))] of n >= 1 sorted values in
/// (0, 1), in any order here (Anderson and Darling 1952): the square of the distance of
/// Kolmogorov-Smirnov, weighted by its variance, so that tails count as much.
double anderson_darling(const Vector& values);
/// P(A^2 of n >= 5 uniform draws is as large): sqrt(3) erfc(sqrt(A^2)), the tail of its limit,
/// sum_j z_j^2 / (j (j + 1)) of normal z_j; by 12 % too small at 0.05, by 6 % at 0.01, less beyond.
double anderson_darling_p_value(double statistic);

/// Tests n >= 1 values in [0, 1]. Throws InputError for none, or one outside, as the next does.
KolmogorovSmirnov test_kolmogorov_smirnov(const Vector& values);
/// `num_bins` >= 2; the p-value needs five values or more in each bin by expectation.
ChiSquare test_chi_square(const Vector& values, Index num_bins);

/// Ranks on 0, ..., num_samples as numbers on (0, 1): (rank + uniform) / (num_samples + 1), exactly
/// uniform when the ranks are, so that neither ties nor the bins' borders bias a test. Value i is a
/// function of `id` and i.
Vector spread_ranks(const std::vector<Index>& ranks, Index num_samples, const StreamId& id);

/// p-value of the smallest of `num_tests` p-values (Bonferroni): min(1, num_tests * smallest).
double corrected(double smallest_p_value, Index num_tests);

}  // namespace npdr::inference
