/// Slice sampling of many chains at once.
///
/// Source: Neal 2003, "Slice sampling", section 4: along one direction after the other, an interval
/// around u grows by stepping out until both ends are below a random level under log p(u), then
/// points are drawn from it, and it shrinks to those that are below, until one is above. There is
/// no step size to tune, and nothing is rejected.
///
/// Every chain has one point at a time that it wants evaluated; those of all chains go to the
/// density in one batch, whatever each of them is doing. Half way through the warm-up the
/// directions turn from the axes to the principal axes of all chains' points, so that correlated
/// parameters mix; widths are the mean interval, after shrinking, of all chains in the warm-up's
/// second half. They are the same for all chains: with its own, long where it lies in a wide mode,
/// a chain would leave such a mode more easily than one with a short width comes back.
#pragma once

#include "core/random.h"
#include "inference/samplers/log_density.h"

namespace npdr::inference {

struct SliceSamplerConfig {
  Index num_warmup = 100;  ///< sweeps over all directions that every chain makes first
  Index thin = 5;          ///< sweeps from one draw of a chain to its next
};

/// Draws of C chains, S each.
struct ChainDraws {
  RowMatrix u;           ///< (S C, D): draw s of chain c in row s C + c
  Index num_chains = 0;  ///< C
  Index num_points = 0;  ///< how often the density was evaluated, over all chains
};

/// `num_draws` draws (S) of each chain; chain c begins at row c of `start` (C, D). A chain's draws
/// depend on `start`, `id` and their own number alone, not on S. Throws InputError when the density
/// is 0 at a start.
ChainDraws slice_sample(const LogDensity& log_density, const RowMatrix& start, Index num_draws,
                        const SliceSamplerConfig& config, const StreamId& id);

}  // namespace npdr::inference
