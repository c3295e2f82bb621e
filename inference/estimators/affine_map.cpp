#include "inference/estimators/affine_map.h"

#include <cmath>

#include "inference/estimators/scalar.h"
#include "inference/estimators/softplus.h"

namespace npdr::inference {
template <typename S>
void AffineMap<S>::forward(const ColumnMatrixX<S>& u, ElementScratch<S>& scratch,
                           ColumnMatrixX<S>& z, VectorX<S>& log_det) const {
  const Index d = u.cols();
  scratch.scale = scratch.raw.leftCols(d);
  scratch.scale = softplus(scratch.scale.array() + S(kScaleOffset)) + S(kSmallestScale);
  z = scratch.scale.array().log();
  log_det += z.rowwise().sum();
  z = u.array() * scratch.scale.array() + scratch.raw.middleCols(d, d).array();
}

template <typename S>
void AffineMap<S>::backward(const ColumnMatrixX<S>& u, const VectorX<S>& d_log_det,
                            ElementScratch<S>& scratch, ColumnMatrixX<S>& d) const {
  scratch.d_raw.resize(u.rows(), scratch.raw.cols());
  // ds/da = sigmoid(a + a_0) = 1 - exp(-softplus(a + a_0)).
  const ColumnMatrixX<S> sigmoid = S(1) - (S(kSmallestScale) - scratch.scale.array()).exp();
  scratch.d_raw.leftCols(u.cols()) =
      (d.array() * u.array() + scratch.scale.array().inverse().colwise() * d_log_det.array()) *
      sigmoid.array();
  scratch.d_raw.middleCols(u.cols(), u.cols()) = d;
  d = d.cwiseProduct(scratch.scale);
}

template <typename S>
VectorX<S> AffineMap<S>::inverse(const VectorX<S>& z, const ColumnMatrixX<S>& raw) const {
  return (z - raw.col(1)).array() /
         (softplus(raw.col(0).array() + S(kScaleOffset)) + S(kSmallestScale));
}

template class AffineMap<NPDR_SCALAR>;

}  // namespace npdr::inference
