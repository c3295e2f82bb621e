/// Whether a posterior is wider than one observation leaves it.
///
/// Of draws theta_i of a posterior and simulations x_i ~ p(x | theta_i), fresh simulations tell of
/// theta what the observation should have told already. The share of Var(theta) that x explains,
///   R^2 = 1 - E Var(theta | x) / Var(theta),
/// is 1/2 at most for a Gaussian likelihood: a second observation halves the variance, and a prior
/// that tells something leaves less to be told. A posterior r times as wide as it should be has
///   R^2 = r^2 / (1 + r^2),   r = sqrt(R^2 / (1 - R^2)).
/// E(theta | x) is a partial least squares regression (Wold 1975; Helland 1988) on normal scores of
/// the features or on these and their squares; of 1000 draws and 2000 features at most. R^2 is the
/// largest of
/// - that of 1, 2 or 3 components in a fifth of the draws that they haven't learned from,
/// - that of one component without the errors of its weights w, which many features have: with w_1
///   and w_2 of halves of the draws, cov(w_1 x, theta) cov(w_2 x, theta) / (cov(w_1 x, w_2 x)
///   Var(theta)) in others (Spearman 1904, correction for attenuation), less three standard errors.
/// What the regression can't tell makes r smaller.
#pragma once

#include "core/types.h"

namespace npdr::inference {

/// Draws from which an excess of width is judged.
inline constexpr Index kFewestForWidth = 100;

/// r of each parameter, (D); 0 of one that is the same in all rows. theta: (n, D), x: (n, F),
/// row i of one is that of the other. Throws ShapeError for other shapes, InputError for fewer rows
/// than kFewestForWidth, or what isn't finite.
Vector excess_width(const RowMatrix& theta, const RowMatrixF& x);

}  // namespace npdr::inference
