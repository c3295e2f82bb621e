/// Noise on observed series.
///
/// No simulator reproduces a device exactly, so recordings lie off the set of simulated series, and
/// a density estimator that was trained on noiseless ones extrapolates. Noise of the size of the
/// residual puts the recordings inside what it has seen.
#pragma once

#include <span>

#include "core/random.h"
#include "core/target.h"
#include "core/types.h"

namespace npdr::sim {

/// The scale of each channel of each rollout, (H, C): max_t |state t| over t = 1, ..., T of the
/// recording, in the channel's unit.
RowMatrix reference_amplitude(const Target& target);

/// Adds independent Gaussian noise to the series of one row, (H, T, C) row-major:
///   series[h, t, c] += deviation(h, c) z,  z ~ N(0, 1).
/// The normals are drawn from `stream` in the order of the series, so the noise of a row depends on
/// the stream's identity and the shape alone. NaN stays NaN. `deviation`: in the channels' units,
/// >= 0. Throws ShapeError unless the series' size is a multiple of H C.
void add_observation_noise(std::span<float> series, const RowMatrix& deviation, Stream& stream);

}  // namespace npdr::sim
