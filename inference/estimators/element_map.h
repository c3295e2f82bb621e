/// Invertible maps of one variable, z = g(u; p), whose parameters p a masked network gives: what
/// makes an autoregressive transform affine or a spline.
///
/// All matrices have a row per sample, and are column-major, so that loops run over samples and
/// variables alike. `raw` (m, P D) holds what the network says, column p D + d the p-th of the P
/// numbers of variable d.
#pragma once

#include "core/types.h"

namespace npdr::inference {

/// The bins of a spline in which each of N values lies.
template <typename S>
struct SplineBins {
  Eigen::VectorXi number;  ///< (N): 0 to K - 1
  VectorX<S> v, z;         ///< (N): lower knot
  VectorX<S> w, h;         ///< (N): width, height
  VectorX<S> d0, d1;       ///< (N): derivatives at both knots
};

/// Memory of forward() for backward(). m rows, D variables, N = m D; the last five lines are the
/// spline's alone, with K bins.
template <typename S>
struct ElementScratch {
  ColumnMatrixX<S> raw, d_raw;            ///< (m, P D)
  ColumnMatrixX<S> scale;                 ///< (m, D)
  ColumnMatrixX<S> moved;                 ///< (m, D): what the spline maps
  ColumnMatrixX<S> widths, heights;       ///< (N, K)
  ColumnMatrixX<S> derivatives;           ///< (N, K - 1)
  SplineBins<S> bins;                     ///< of the N values of `moved`
  ColumnMatrixX<S> log_slope, d_element;  ///< (m, D), (N, 5)
};

/// Const calls are thread-safe; each thread brings a scratch of its own.
template <typename S>
class ElementMap {
 public:
  virtual ~ElementMap() = default;

  /// P. At p = 0 the map is the identity.
  virtual Index num_parameters() const = 0;

  /// z(u), (m, D), with scratch.raw set; adds sum_d log dz_d/du_d to `log_det` (m).
  virtual void forward(const ColumnMatrixX<S>& u, ElementScratch<S>& scratch, ColumnMatrixX<S>& z,
                       VectorX<S>& log_det) const = 0;

  /// Given dL/dz in `d` and dL/dlog_det (m), sets scratch.d_raw to dL/draw and `d` to dL/du.
  virtual void backward(const ColumnMatrixX<S>& u, const VectorX<S>& d_log_det,
                        ElementScratch<S>& scratch, ColumnMatrixX<S>& d) const = 0;

  /// u(z) of one variable, (m), with its `raw` (m, P).
  virtual VectorX<S> inverse(const VectorX<S>& z, const ColumnMatrixX<S>& raw) const = 0;
};

}  // namespace npdr::inference
