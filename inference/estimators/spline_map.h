/// Monotonic rational-quadratic spline after an affine map: the map of a neural spline flow.
///
/// Source: Durkan, Bekasov, Murray and Papamakarios 2019, "Neural spline flows", eqs. 4-8. First
/// v = s u + t (affine_map.h), so that the spline sees its variable at unit scale however narrow
/// the density is. Then, for v in [-B, B], B = 5, with K bins between the knots (v_k, z_k) and
/// positive derivatives d_k there (d_0 = d_K = 1),
///   xi = (v - v_k) / w_k,   s_k = h_k / w_k,   D = s_k + (d_{k+1} + d_k - 2 s_k) xi (1 - xi),
///   z = z_k + h_k (s_k xi^2 + d_k xi (1 - xi)) / D,
///   dz/dv = s_k^2 (d_{k+1} xi^2 + 2 s_k xi (1 - xi) + d_k (1 - xi)^2) / D^2;
/// outside z = v. The network gives P = 2 + 3 K - 1 numbers per variable: a, t; K of the widths w
/// and K of the heights h, through a softmax that leaves every bin 1e-3 of the whole; K - 1
/// derivatives, softplus(. + c) + 1e-3 with c such that 0 means 1.
#pragma once

#include "inference/estimators/affine_map.h"

namespace npdr::inference {

template <typename S>
class SplineMap : public ElementMap<S> {
 public:
  /// Throws InputError for fewer than 2 bins or more than 100.
  explicit SplineMap(Index num_bins);

  Index num_parameters() const override { return 2 + 3 * bins_ - 1; }
  void forward(const ColumnMatrixX<S>& u, ElementScratch<S>& scratch, ColumnMatrixX<S>& z,
               VectorX<S>& log_det) const override;
  void backward(const ColumnMatrixX<S>& u, const VectorX<S>& d_log_det, ElementScratch<S>& scratch,
                ColumnMatrixX<S>& d) const override;
  VectorX<S> inverse(const VectorX<S>& z, const ColumnMatrixX<S>& raw) const override;

 private:
  void shape(ElementScratch<S>& scratch, Index num_variables) const;

  AffineMap<S> affine_;
  Index bins_;
};

}  // namespace npdr::inference
