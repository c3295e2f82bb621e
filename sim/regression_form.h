/// Equations of motion as a linear regression: what a simulator offers whose inverse dynamics are
/// linear in functions w (W) of its domain parameters,
///   Phi(motion) w = response(motion, known parameters),
/// so that w can be estimated from recordings without a simulation.
#pragma once

#include <vector>

#include "core/target.h"
#include "core/types.h"

namespace npdr::sim {

/// One equation a row.
struct RegressionRows {
  RowMatrix regressors;  ///< (rows, W)
  Vector response;       ///< (rows)
};

/// Const calls are thread-safe. `known` (P) holds all parameters of the simulator; those that the
/// regression identifies are not looked at.
class RegressionForm {
 public:
  virtual ~RegressionForm() = default;

  /// Positions in theta of the parameters that follow from w; all others are taken as known.
  virtual std::vector<Index> identified() const = 0;

  /// The equations at every recorded state of every rollout that has (window - 1) / 2 neighbors on
  /// either side: derivatives and states come from a smoother that looks at `window` states. Throws
  /// InputError for other channels, a window that is even, shorter than 5 or longer than a rollout.
  virtual RegressionRows rows(const Target& target, const Vector& known, Index window) const = 0;

  /// `known` with the parameters that w (W) stands for in place of the identified ones. They may be
  /// physically impossible, infinite or NaN: noise puts w where no device is.
  virtual Vector recover(const Vector& w, const Vector& known) const = 0;
};

}  // namespace npdr::sim
