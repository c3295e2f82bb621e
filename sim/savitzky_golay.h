/// Smoothing and differentiation of a sampled signal by local polynomials.
///
/// Source: Savitzky and Golay 1964, "Smoothing and differentiation of data by simplified least
/// squares procedures". The polynomial of `degree` that fits the 2 m + 1 = window samples around t
/// best has, at t, the value and slope
///   p(t) = sum_j a_j x[t + j],      p'(t) = sum_j b_j x[t + j],      j = -m, ..., m.
#pragma once

#include "core/types.h"

namespace npdr::sim {

/// Weights of a window's samples.
struct SavitzkyGolay {
  Vector smooth;  ///< a, (window)
  Vector slope;   ///< b, (window) [1/s]

  /// The average over the steps between the window's samples that belongs to the slope: with x the
  /// integral of f, held over each step, sum_j b_j x[t + j] = sum_k g_k f[t + k], k = -m, ...,
  /// m - 1. (window - 1)
  Vector step_average(double dt) const;
};

/// `dt` [s] between samples. Throws InputError unless the window is odd and longer than degree + 1.
SavitzkyGolay savitzky_golay(Index window, Index degree, double dt);

/// Slopes of samples (n) at each of them (n) [1/s]: of the cubic over the window around it. Where
/// an end is nearer than window / 2 samples, of the quadratic over the first or last window: a
/// cubic's slope at its own end amplifies noise more than twice as much. Throws InputError unless
/// the window is odd, at least 5, and no longer than the samples.
Vector slopes(const Vector& samples, Index window, double dt);

}  // namespace npdr::sim
