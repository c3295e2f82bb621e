/// Noise of a recording, by itself: how far neighboring samples scatter around the motion.
///
/// Third differences hold nothing of a smooth motion, and of white noise of variance sigma^2 they
/// have the variance binom(6, 3) sigma^2 = 20 sigma^2 (von Neumann 1941; Hall, Kay and Titterington
/// 1990). So
///   sigma = 1.4826 median_t |D^3 y_t| / sqrt(20),
/// where single glitches mean nothing. Rounding is noise all the same where a series hardly moves:
/// there it is tick / sqrt(12), the tick being the smallest step. Noise that stays for many
/// samples, as that of filters, may be larger.
#pragma once

#include "core/types.h"

namespace npdr::analysis {

/// The smallest step of a series (n) but for what arithmetic leaves, 1e-9 of its largest magnitude:
/// an encoder's count. 0: it stands still.
double smallest_step(const Vector& series);

/// sigma of a series (n), in its unit; 0 of one that stands still, and of fewer than 4 samples. It
/// may be too small of rates that were computed or filtered: these hardly scatter, whatever their
/// noise.
double scatter(const Vector& series);

}  // namespace npdr::analysis
