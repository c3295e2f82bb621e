/// Invertible maps of one variable, z = g(u; p), whose parameters p a masked network gives: what
/// makes an autoregressive transform affine or a spline.
///
/// All matrices have a row per sample. `raw` (m, P D) holds what the network says, column p D + d
/// the p-th of the P numbers of variable d.
#pragma once

#include "core/types.h"

namespace npdr::inference {

/// Memory of forward() for backward(). m rows, D variables, K bins; the second line is the
/// spline's alone.
template <typename S>
struct ElementScratch {
  RowMatrixX<S> raw, d_raw;                     ///< (m, P D)
  RowMatrixX<S> scale;                          ///< (m, D)
  RowMatrixX<S> moved;                          ///< (m, D): what the spline maps
  RowMatrixX<S> widths, heights, derivatives;   ///< (m, K D), (m, K D), (m, (K - 1) D)
  RowMatrixX<S> slope, numerator, denominator;  ///< (m, D)
};

/// Const calls are thread-safe; each thread brings a scratch of its own.
template <typename S>
class ElementMap {
 public:
  virtual ~ElementMap() = default;

  /// P. At p = 0 the map is the identity.
  virtual Index num_parameters() const = 0;

  /// z(u), (m, D), with scratch.raw set; adds sum_d log dz_d/du_d to `log_det` (m).
  virtual void forward(const RowMatrixX<S>& u, ElementScratch<S>& scratch, RowMatrixX<S>& z,
                       VectorX<S>& log_det) const = 0;

  /// Given dL/dz in `d` and dL/dlog_det (m), sets scratch.d_raw to dL/draw and `d` to dL/du.
  virtual void backward(const RowMatrixX<S>& u, const VectorX<S>& d_log_det,
                        ElementScratch<S>& scratch, RowMatrixX<S>& d) const = 0;

  /// u(z) of one variable, (m), with its `raw` (m, P).
  virtual VectorX<S> inverse(const VectorX<S>& z, const RowMatrixX<S>& raw) const = 0;
};

}  // namespace npdr::inference
