#include "inference/estimators/spline_map.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"
#include "inference/estimators/estimator_config.h"
#include "inference/estimators/softplus.h"

namespace npdr::inference {
namespace {

constexpr double kBound = 5.0;  // B: the prior N(0, I) leaves [-B, B] with probability 6e-7
constexpr double kSmallestBin = 1e-3;
constexpr double kSmallestDerivative = 1e-3;
// softplus(kDerivativeOffset) + kSmallestDerivative = 1.
const double kDerivativeOffset = std::log(std::expm1(1.0 - kSmallestDerivative));

// Column k D + d of `result` = 2 B (m + (1 - K m) softmax_k(raw)), for all rows and variables at
// once. Eigen vectorizes functions of whole matrices; of D columns only where D is large.
template <typename S>
void bins_of(const Eigen::Ref<const RowMatrixX<S>>& raw, Index bins, RowMatrixX<S>& result) {
  const Index d = raw.cols() / bins;
  RowMatrixX<S> largest = raw.leftCols(d);
  for (Index k = 1; k < bins; ++k) largest = largest.cwiseMax(raw.middleCols(k * d, d));
  result.resize(raw.rows(), raw.cols());
  RowMatrixX<S> sum = RowMatrixX<S>::Zero(raw.rows(), d);
  for (Index k = 0; k < bins; ++k) {
    result.middleCols(k * d, d) = raw.middleCols(k * d, d) - largest;
  }
  result.array() = result.array().exp();
  for (Index k = 0; k < bins; ++k) sum += result.middleCols(k * d, d);
  const S smallest = S(2.0 * kBound * kSmallestBin);
  const S rest = S(2.0 * kBound * (1.0 - static_cast<double>(bins) * kSmallestBin));
  sum = rest * sum.array().inverse();
  for (Index k = 0; k < bins; ++k) {
    result.middleCols(k * d, d) = smallest + result.middleCols(k * d, d).array() * sum.array();
  }
}

// Turns dL/dwidths of one variable (its K entries, `stride` apart) into dL/draw: the softmax's
// Jacobian. `sizes` are the bins.
template <typename S>
void softmax_backward(const S* sizes, S* d, Index bins, Index stride) {
  const S smallest = S(2.0 * kBound * kSmallestBin);
  const S rest = S(2.0 * kBound * (1.0 - static_cast<double>(bins) * kSmallestBin));
  S mean = 0;
  for (Index k = 0; k < bins; ++k) mean += d[k * stride] * (sizes[k * stride] - smallest) / rest;
  for (Index k = 0; k < bins; ++k) {
    d[k * stride] = (d[k * stride] - mean) * (sizes[k * stride] - smallest);
  }
}

}  // namespace

// One bin and its knots.
template <typename S>
struct SplineMap<S>::Bin {
  Index k = 0;
  S v, z;    // lower knot
  S w, h;    // width, height
  S d0, d1;  // derivatives at both knots
};

template <typename S>
SplineMap<S>::SplineMap(Index num_bins) : bins_(num_bins) {
  constexpr Range allowed = EstimatorConfig::kNumBins;
  if (!allowed.contains(static_cast<double>(num_bins))) {
    throw InputError(fmt::format("density_estimator.num_bins = {}, must be {} to {}", num_bins,
                                 allowed.low, allowed.high));
  }
}

template <typename S>
void SplineMap<S>::shape(ElementScratch<S>& scratch, Index d) const {
  bins_of<S>(scratch.raw.middleCols(2 * d, bins_ * d), bins_, scratch.widths);
  bins_of<S>(scratch.raw.middleCols((2 + bins_) * d, bins_ * d), bins_, scratch.heights);
  scratch.derivatives = scratch.raw.rightCols((bins_ - 1) * d);
  scratch.derivatives =
      softplus(scratch.derivatives.array() + S(kDerivativeOffset)) + S(kSmallestDerivative);
}

// The bin in which `value` lies along `knots_of`: the widths for v, the heights for z.
template <typename S>
typename SplineMap<S>::Bin SplineMap<S>::find(const ElementScratch<S>& scratch,
                                              const RowMatrixX<S>& knots_of, Index row, Index d,
                                              Index num_variables, S value) const {
  Bin bin;
  bin.v = bin.z = S(-kBound);
  S knot = S(-kBound);
  while (bin.k + 1 < bins_ && value >= knot + knots_of(row, bin.k * num_variables + d)) {
    knot += knots_of(row, bin.k * num_variables + d);
    bin.v += scratch.widths(row, bin.k * num_variables + d);
    bin.z += scratch.heights(row, bin.k * num_variables + d);
    ++bin.k;
  }
  const auto derivative = [&](Index knot_number) {
    const bool is_end = knot_number == 0 || knot_number == bins_;
    return is_end ? S(1) : scratch.derivatives(row, (knot_number - 1) * num_variables + d);
  };
  bin.w = scratch.widths(row, bin.k * num_variables + d);
  bin.h = scratch.heights(row, bin.k * num_variables + d);
  bin.d0 = derivative(bin.k);
  bin.d1 = derivative(bin.k + 1);
  return bin;
}

template <typename S>
void SplineMap<S>::forward(const RowMatrixX<S>& u, ElementScratch<S>& scratch, RowMatrixX<S>& z,
                           VectorX<S>& log_det) const {
  const Index num_variables = u.cols();
  affine_.forward(u, scratch, scratch.moved, log_det);
  shape(scratch, num_variables);
  z = scratch.moved;
  // Parts of dz/dv = slope^2 numerator / denominator^2; 1 outside of [-B, B].
  scratch.slope.setOnes(u.rows(), num_variables);
  scratch.numerator.setOnes(u.rows(), num_variables);
  scratch.denominator.setOnes(u.rows(), num_variables);
  for (Index i = 0; i < u.rows(); ++i) {
    for (Index d = 0; d < num_variables; ++d) {
      const S v = scratch.moved(i, d);
      if (!(std::abs(v) < S(kBound))) continue;
      const Bin b = find(scratch, scratch.widths, i, d, num_variables, v);
      const S xi = (v - b.v) / b.w, q = xi * (1 - xi), s = b.h / b.w;
      const S denominator = s + (b.d1 + b.d0 - 2 * s) * q;
      z(i, d) = b.z + b.h * (s * xi * xi + b.d0 * q) / denominator;
      scratch.slope(i, d) = s;
      scratch.numerator(i, d) = b.d1 * xi * xi + 2 * s * q + b.d0 * (1 - xi) * (1 - xi);
      scratch.denominator(i, d) = denominator;
    }
  }
  scratch.slope =
      ((scratch.slope.array() / scratch.denominator.array()).square() * scratch.numerator.array())
          .log();
  log_det += scratch.slope.rowwise().sum();
}

// With N = h (s xi^2 + d_0 q), A = d_1 xi^2 + 2 s q + d_0 (1 - xi)^2 and D the denominator,
// z = z_k + N / D and log dz/dv = 2 log s + log A - 2 log D: partial derivatives by xi, s, h, d_0,
// d_1 and the lower knot, then the chain rule to v, widths and heights. The knots are sums of the
// bins below.
template <typename S>
void SplineMap<S>::backward(const RowMatrixX<S>& u, const VectorX<S>& d_log_det,
                            ElementScratch<S>& scratch, RowMatrixX<S>& d_z) const {
  const Index n = u.cols();
  scratch.d_raw.setZero(u.rows(), scratch.raw.cols());
  for (Index i = 0; i < u.rows(); ++i) {
    for (Index d = 0; d < n; ++d) {
      const S v = scratch.moved(i, d);
      if (!(std::abs(v) < S(kBound))) continue;
      const Bin b = find(scratch, scratch.widths, i, d, n, v);
      const S xi = (v - b.v) / b.w, q = xi * (1 - xi), s = b.h / b.w;
      const S den = scratch.denominator(i, d), a = scratch.numerator(i, d);
      const S num = b.h * (s * xi * xi + b.d0 * q);
      const S g = d_z(i, d), l = d_log_det(i);
      const auto total = [&](S by_num, S by_den, S by_a) {
        return g * (by_num - num * by_den / den) / den + l * (by_a / a - 2 * by_den / den);
      };
      const S bend = b.d1 + b.d0 - 2 * s;
      const S by_xi = total(b.h * (2 * s * xi + b.d0 * (1 - 2 * xi)), bend * (1 - 2 * xi),
                            2 * (b.d1 * xi + s * (1 - 2 * xi) - b.d0 * (1 - xi)));
      const S by_s = total(b.h * xi * xi, 1 - 2 * q, 2 * q) + 2 * l / s;
      const S by_h = g * num / b.h / den + by_s / b.w;
      const S by_w = -(by_xi * xi + by_s * s) / b.w;
      S* d_widths = &scratch.d_raw(i, 2 * n + d);
      S* d_heights = &scratch.d_raw(i, (2 + bins_) * n + d);
      for (Index k = 0; k < b.k; ++k) {
        d_widths[k * n] = -by_xi / b.w;
        d_heights[k * n] = g;
      }
      d_widths[b.k * n] = by_w;
      d_heights[b.k * n] = by_h;
      softmax_backward(&scratch.widths(i, d), d_widths, bins_, n);
      softmax_backward(&scratch.heights(i, d), d_heights, bins_, n);
      S* d_derivatives = &scratch.d_raw(i, (2 + 2 * bins_) * n + d);
      if (b.k > 0) {
        d_derivatives[(b.k - 1) * n] = total(b.h * q, q, (1 - xi) * (1 - xi));
      }
      if (b.k + 1 < bins_) d_derivatives[b.k * n] = total(0, q, xi * xi);
      d_z(i, d) = by_xi / b.w;
    }
  }
  // softplus'(x) = 1 - exp(-softplus(x)).
  scratch.d_raw.rightCols((bins_ - 1) * n).array() *=
      S(1) - (S(kSmallestDerivative) - scratch.derivatives.array()).exp();
  affine_.backward(u, d_log_det, scratch, d_z);
}

// The root of a xi^2 + b xi + c = 0 that lies in [0, 1] (eqs. 6-8), written without cancellation.
template <typename S>
VectorX<S> SplineMap<S>::inverse(const VectorX<S>& z, const RowMatrixX<S>& raw) const {
  ElementScratch<S> scratch;
  scratch.raw = raw;
  shape(scratch, 1);
  VectorX<S> v = z;
  for (Index i = 0; i < z.size(); ++i) {
    if (!(std::abs(z(i)) < S(kBound))) continue;
    const Bin bin = find(scratch, scratch.heights, i, 0, 1, z(i));
    const S s = bin.h / bin.w, y = z(i) - bin.z, bend = bin.d1 + bin.d0 - 2 * s;
    const S a = bin.h * (s - bin.d0) + y * bend;
    const S b = bin.h * bin.d0 - y * bend;
    const S c = -s * y;
    const S root = std::sqrt(std::max(S(0), b * b - 4 * a * c));
    v(i) = bin.v + bin.w * 2 * c / (-b - root);
  }
  return affine_.inverse(v, raw.leftCols(2));
}

template class SplineMap<float>;
template class SplineMap<double>;

}  // namespace npdr::inference
