/// Cost of errors with Student's t distribution and an unknown scale for each channel.
///
/// Errors e of N_c values of channel c have the density of s_c t_nu. The scales of largest
/// likelihood solve
///   s_c^2 = 1 / N_c sum w e^2,   w = (nu + 1) / (nu + (e / s_c)^2)
/// (Lange, Little and Taylor 1989), whose steps are those of an EM algorithm, and the cost is
///   sum_c [ N_c log s_c + (nu + 1) / 2 sum log(1 + (e / s_c)^2 / nu) ]   [nats].
/// An error far beyond the scale hardly moves the minimum; a channel counts by what is left of it.
#pragma once

#include "core/types.h"

namespace npdr::inference {

struct StudentErrors {
  double degrees_of_freedom = 4.0;  ///< nu; Gaussian errors: 89 % as efficient
  Vector smallest_scales;           ///< (C) > 0: no channel is fitted better than that

  Index num_channels() const { return smallest_scales.size(); }

  /// Scales (C) of errors (N, C), from a first guess of them; none: their root mean square.
  Vector scales(const RowMatrix& errors, const Vector& guess = {}) const;
  /// The cost with these scales [nats]; infinity of errors that aren't finite.
  double cost(const RowMatrix& errors, const Vector& scales) const;

  /// Derivative of the cost by each error, times its scale: psi(z) = (nu + 1) z / (nu + z^2), (N,
  /// C).
  RowMatrix scores(const RowMatrix& errors, const Vector& scales) const;
  /// w above, (N, C).
  RowMatrix weights(const RowMatrix& errors, const Vector& scales) const;
  /// Mean of psi'(z) over each channel, (C), at least a hundredth.
  Vector curvatures(const RowMatrix& errors, const Vector& scales) const;
};

}  // namespace npdr::inference
