/// Length of Metropolis steps.
#pragma once

namespace npdr::inference {

/// Deviation of the steps that mix fastest, over sqrt(D), in deviations of a Gaussian density of D
/// dimensions (Gelman, Roberts and Gilks 1996); of differences of two of its draws over sqrt(2 D)
/// (ter Braak 2006).
inline constexpr double kBestStep = 2.38;

/// Deviation of the logarithm of a step's length, where steps are of several lengths. By hand.
inline constexpr double kSpreadOfSteps = 0.5;

}  // namespace npdr::inference
