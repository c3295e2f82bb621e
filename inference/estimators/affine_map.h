/// z = s u + t with p = (a, t): the map of a masked autoregressive flow (Papamakarios, Pavlakou and
/// Murray 2017, eqs. 3-4).
///
///   s = softplus(a + a_0) + 1e-3 with a_0 such that s = 1 at a = 0.
/// A softplus scale (not an exponential one) grows linearly: contexts far from the training data
/// don't blow up.
#pragma once

#include "inference/estimators/element_map.h"

namespace npdr::inference {

template <typename S>
class AffineMap : public ElementMap<S> {
 public:
  Index num_parameters() const override { return 2; }
  void forward(const ColumnMatrixX<S>& u, ElementScratch<S>& scratch, ColumnMatrixX<S>& z,
               VectorX<S>& log_det) const override;
  void backward(const ColumnMatrixX<S>& u, const VectorX<S>& d_log_det, ElementScratch<S>& scratch,
                ColumnMatrixX<S>& d) const override;
  VectorX<S> inverse(const VectorX<S>& z, const ColumnMatrixX<S>& raw) const override;
};

}  // namespace npdr::inference
