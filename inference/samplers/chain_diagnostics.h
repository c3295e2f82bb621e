/// Diagnostics of an MCMC sampler: whether its chains agree, and how much their draws are worth.
///
/// Source: Vehtari et al. 2021, "Rank-normalization, folding, and localization: an improved R-hat",
/// eqs. 1-4 (split R-hat) and 10-12 (effective sample size with Geyer's initial monotone sequence),
/// without rank normalization.
#pragma once

#include "inference/samplers/slice_sampler.h"

namespace npdr::inference {

/// Largest R-hat at which chains count as having found the same places (Gelman et al. 2013,
/// "Bayesian data analysis", section 11.5).
inline constexpr double kLargestRHat = 1.1;

/// Diagnostics of each coordinate.
struct ChainDiagnostics {
  Vector r_hat;  ///< (D); 1 when the halves of all chains agree, above 1.01 they don't
  Vector ess;    ///< (D), of the S C draws; NaN together with r_hat for fewer than 4 draws a chain
};

ChainDiagnostics diagnose(const ChainDraws& draws);

}  // namespace npdr::inference
