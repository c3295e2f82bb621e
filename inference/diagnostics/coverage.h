/// Do credible regions hold the truth as often as they say?
///
/// Two families of regions, of L samples of the posterior given the x of a known theta*:
/// - highest density (Hermans et al. 2022, "A crisis in simulation-based inference? Beware, your
///   posterior approximations can be unfaithful"; Deistler, Goncalves and Macke 2022, "Truncated
///   proposals for scalable and hassle-free simulation-based inference"): theta* enters at the
///   level of the share of samples that are more likely than theta*;
/// - balls around a random point (Lemos et al. 2023, "Sampling-based accuracy testing of posterior
///   estimators for general inference", TARP): at the share of samples that are nearer to it.
/// Over many theta* from the prior these levels are uniform when the posterior is right. Coverage
/// below a level above 1/2: too narrow, or beside the truth; above it: too wide. At levels below
/// 1/2 the same holds for regions of highest density, and for balls the opposite: a ball that a
/// tenth of the samples lie in misses all of a posterior that is too wide.
#pragma once

#include "inference/diagnostics/uniformity.h"

namespace npdr::inference {

/// Number of the samples' log densities (L) that are above the truth's: 0, ..., L.
Index density_rank(const Vector& log_prob_of_samples, double log_prob_of_truth);

/// Number of `samples` (L, D) that are nearer to `reference` (D) than `truth` (D) is: 0, ..., L.
Index distance_rank(const RowMatrix& samples, const Vector& truth, const Vector& reference);

/// The share of truths within the regions of each level.
struct Coverage {
  Vector level;     ///< (101) 0, 0.01, ..., 1
  Vector coverage;  ///< (101)
  /// Mean of coverage - level over the levels above 1/2 ("area to curve"): > 0 where the posterior
  /// is too wide, < 0 where it is too narrow, or beside the truth.
  double area = 0.0;
  KolmogorovSmirnov kolmogorov_smirnov;
};

/// Coverage by the n levels at which truths enter: ranks as spread_ranks() gives them. Throws
/// InputError for none.
Coverage measure_coverage(const Vector& spread);

}  // namespace npdr::inference
