#include "inference/estimators/spline_map.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"
#include "inference/estimators/estimator_config.h"
#include "inference/estimators/scalar.h"
#include "inference/estimators/softplus.h"

namespace npdr::inference {
namespace {

constexpr double kBound = 5.0;  // B: the prior N(0, I) leaves [-B, B] with probability 6e-7
constexpr double kSmallestBin = 1e-3;

// Column k of `sizes` = 2 B (m + (1 - K m) softmax_k(raw)); `raw` holds N values for each of K
// bins.
template <typename S>
void sizes_of(const S* raw, Index num_values, Index bins, ColumnMatrixX<S>& sizes) {
  const Eigen::Map<const ColumnMatrixX<S>> logits(raw, num_values, bins);
  VectorX<S> largest = logits.col(0), sum = VectorX<S>::Zero(num_values);
  for (Index k = 1; k < bins; ++k) largest = largest.cwiseMax(logits.col(k));
  sizes.resize(num_values, bins);
  for (Index k = 0; k < bins; ++k) {
    sizes.col(k) = (logits.col(k) - largest).array().exp();
    sum += sizes.col(k);
  }
  const S smallest = S(2.0 * kBound * kSmallestBin);
  const S rest = S(2.0 * kBound * (1.0 - static_cast<double>(bins) * kSmallestBin));
  sum = rest * sum.array().inverse();
  for (Index k = 0; k < bins; ++k) {
    sizes.col(k) = smallest + sizes.col(k).array() * sum.array();
  }
}

// Turns dL/dsizes (N, K) into dL/draw: the softmax's Jacobian.
template <typename S>
void softmax_backward(const ColumnMatrixX<S>& sizes, S* d_raw) {
  const Index bins = sizes.cols();
  Eigen::Map<ColumnMatrixX<S>> d(d_raw, sizes.rows(), bins);
  const S smallest = S(2.0 * kBound * kSmallestBin);
  const S rest = S(2.0 * kBound * (1.0 - static_cast<double>(bins) * kSmallestBin));
  VectorX<S> mean = VectorX<S>::Zero(sizes.rows());
  for (Index k = 0; k < bins; ++k) {
    mean.array() += d.col(k).array() * (sizes.col(k).array() - smallest) / rest;
  }
  for (Index k = 0; k < bins; ++k) {
    d.col(k).array() = (d.col(k) - mean).array() * (sizes.col(k).array() - smallest);
  }
}

enum class Axis { v, z };

// The bins in which N values lie along an axis: the last one whose lower knot isn't above the
// value.
template <Axis kAxis, typename S>
void find_bins(const ElementScratch<S>& scratch, const S* values, SplineBins<S>& bins) {
  const Index n = scratch.widths.rows(), num_bins = scratch.widths.cols();
  bins.number.setZero(n);
  bins.v.setConstant(n, S(-kBound));
  bins.z = bins.v;
  bins.w = scratch.widths.col(0);
  bins.h = scratch.heights.col(0);
  bins.d0.setOnes(n);
  bins.d1 = scratch.derivatives.col(0);
  VectorX<S> knot_v = bins.v, knot_z = bins.z;
  const VectorX<S> one = VectorX<S>::Ones(n);
  for (Index k = 1; k < num_bins; ++k) {
    knot_v += scratch.widths.col(k - 1);
    knot_z += scratch.heights.col(k - 1);
    const S* knot = kAxis == Axis::v ? knot_v.data() : knot_z.data();
    const auto take = [&](const S* candidates, S* kept) {
#pragma omp simd
      for (Index i = 0; i < n; ++i) kept[i] = values[i] >= knot[i] ? candidates[i] : kept[i];
    };
    take(knot_v.data(), bins.v.data());
    take(knot_z.data(), bins.z.data());
    take(scratch.widths.col(k).data(), bins.w.data());
    take(scratch.heights.col(k).data(), bins.h.data());
    take(scratch.derivatives.col(k - 1).data(), bins.d0.data());
    take(k + 1 < num_bins ? scratch.derivatives.col(k).data() : one.data(), bins.d1.data());
    int* number = bins.number.data();
#pragma omp simd
    for (Index i = 0; i < n; ++i) number[i] += values[i] >= knot[i] ? 1 : 0;
  }
}

// A value in its bin: N = h (s xi^2 + d_0 q), A = d_1 xi^2 + 2 s q + d_0 (1 - xi)^2 and the
// denominator D, so that z = z_k + N / D and dz/dv = s^2 A / D^2.
template <typename S>
struct Fraction {
  S xi, q, s, numerator, slope_numerator, denominator;

  Fraction(S v, S knot, S w, S h, S d0, S d1) {
    xi = (v - knot) / w;
    q = xi * (1 - xi);
    s = h / w;
    numerator = h * (s * xi * xi + d0 * q);
    slope_numerator = d1 * xi * xi + 2 * s * q + d0 * (1 - xi) * (1 - xi);
    denominator = s + (d1 + d0 - 2 * s) * q;
  }
};

template <typename S>
bool is_inside(S v) {
  return std::abs(v) < S(kBound);
}

// Partial derivatives of z and of log dz/dv = 2 log s + log A - 2 log D by xi, s, h, d_0, d_1 and
// the lower knot, then the chain rule to v, w and h: columns v, w, h, d_0, d_1 of d_element.
template <typename S>
void differentiate_elements(const S* by_z, const VectorX<S>& by_log_det,
                            ElementScratch<S>& scratch) {
  const Index n = by_log_det.size();
  const SplineBins<S>& bins = scratch.bins;
  scratch.d_element.resize(n, 5);
  S *by_v = scratch.d_element.col(0).data(), *by_w = scratch.d_element.col(1).data(),
    *by_h = scratch.d_element.col(2).data(), *by_d0 = scratch.d_element.col(3).data(),
    *by_d1 = scratch.d_element.col(4).data();
  const S *v = scratch.moved.data(), *knot_v = bins.v.data(), *w = bins.w.data(),
          *h = bins.h.data(), *d0 = bins.d0.data(), *d1 = bins.d1.data(), *det = by_log_det.data();
#pragma omp simd
  for (Index i = 0; i < n; ++i) {
    const bool inside = is_inside(v[i]);
    const Fraction<S> f(inside ? v[i] : knot_v[i], knot_v[i], w[i], h[i], d0[i], d1[i]);
    const S g = inside ? by_z[i] : S(0), l = inside ? det[i] : S(0);
    const S z_by_num = g / f.denominator;
    const S by_den = -(z_by_num * f.numerator + 2 * l) / f.denominator;
    const S by_a = l / f.slope_numerator;
    const S by_xi = z_by_num * h[i] * (2 * f.s * f.xi + d0[i] * (1 - 2 * f.xi)) +
                    by_den * (d1[i] + d0[i] - 2 * f.s) * (1 - 2 * f.xi) +
                    by_a * 2 * (d1[i] * f.xi + f.s * (1 - 2 * f.xi) - d0[i] * (1 - f.xi));
    const S by_s =
        z_by_num * h[i] * f.xi * f.xi + by_den * (1 - 2 * f.q) + by_a * 2 * f.q + 2 * l / f.s;
    by_v[i] = by_xi / w[i];
    by_h[i] = z_by_num * f.numerator / h[i] + by_s / w[i];
    by_w[i] = -(by_xi * f.xi + by_s * f.s) / w[i];
    by_d0[i] = z_by_num * h[i] * f.q + by_den * f.q + by_a * (1 - f.xi) * (1 - f.xi);
    by_d1[i] = by_den * f.q + by_a * f.xi * f.xi;
  }
}

// What the element says of its own bin goes to all widths, heights and derivatives (d_widths, n
// numbers a bin, and what follows it): the knots are sums of the bins below.
template <typename S>
void spread_over_bins(const S* by_z, const ElementScratch<S>& scratch, S* d_widths) {
  const Index n = scratch.d_element.rows();
  const int num_bins = static_cast<int>(scratch.widths.cols());
  const S *by_v = scratch.d_element.col(0).data(), *by_w = scratch.d_element.col(1).data(),
          *by_h = scratch.d_element.col(2).data(), *by_d0 = scratch.d_element.col(3).data(),
          *by_d1 = scratch.d_element.col(4).data(), *v = scratch.moved.data();
  const int* number = scratch.bins.number.data();
  S* d_heights = d_widths + num_bins * n;
  S* d_derivatives = d_heights + num_bins * n;
  for (int k = 0; k < num_bins; ++k, d_widths += n, d_heights += n) {
#pragma omp simd
    for (Index i = 0; i < n; ++i) {
      const S below = is_inside(v[i]) ? S(1) : S(0);
      d_widths[i] = k < number[i] ? -by_v[i] : (k == number[i] ? by_w[i] : S(0));
      d_heights[i] = k < number[i] ? below * by_z[i] : (k == number[i] ? by_h[i] : S(0));
    }
  }
  for (int k = 0; k + 1 < num_bins; ++k, d_derivatives += n) {
#pragma omp simd
    for (Index i = 0; i < n; ++i) {
      d_derivatives[i] = number[i] == k + 1 ? by_d0[i] : (number[i] == k ? by_d1[i] : S(0));
    }
  }
}

}  // namespace

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
  const Index n = scratch.raw.rows() * d;
  const S* raw = scratch.raw.data();
  sizes_of(raw + 2 * n, n, bins_, scratch.widths);
  sizes_of(raw + (2 + bins_) * n, n, bins_, scratch.heights);
  scratch.derivatives = Eigen::Map<const ColumnMatrixX<S>>(raw + (2 + 2 * bins_) * n, n, bins_ - 1);
  scratch.derivatives = softplus(scratch.derivatives.array() + S(kScaleOffset)) + S(kSmallestScale);
}

template <typename S>
void SplineMap<S>::forward(const ColumnMatrixX<S>& u, ElementScratch<S>& scratch,
                           ColumnMatrixX<S>& z, VectorX<S>& log_det) const {
  affine_.forward(u, scratch, scratch.moved, log_det);
  shape(scratch, u.cols());
  find_bins<Axis::v>(scratch, scratch.moved.data(), scratch.bins);
  z.resize(u.rows(), u.cols());
  scratch.log_slope.resize(u.rows(), u.cols());
  const SplineBins<S>& b = scratch.bins;
  const S* v = scratch.moved.data();
  const S *knot_v = b.v.data(), *knot_z = b.z.data(), *w = b.w.data(), *h = b.h.data(),
          *d0 = b.d0.data(), *d1 = b.d1.data();
  S *value = z.data(), *slope = scratch.log_slope.data();
#pragma omp simd
  for (Index i = 0; i < u.size(); ++i) {
    const bool inside = is_inside(v[i]);
    const Fraction<S> f(inside ? v[i] : knot_v[i], knot_v[i], w[i], h[i], d0[i], d1[i]);
    const S root = f.s / f.denominator;
    value[i] = inside ? knot_z[i] + f.numerator / f.denominator : v[i];
    slope[i] = inside ? root * root * f.slope_numerator : S(1);
  }
  scratch.log_slope = scratch.log_slope.array().log();
  log_det += scratch.log_slope.rowwise().sum();
}

template <typename S>
void SplineMap<S>::backward(const ColumnMatrixX<S>& u, const VectorX<S>& d_log_det,
                            ElementScratch<S>& scratch, ColumnMatrixX<S>& d_z) const {
  const Index n = u.size();
  scratch.d_raw.resize(u.rows(), scratch.raw.cols());
  S* d_widths = scratch.d_raw.data() + 2 * n;
  S* d_heights = d_widths + bins_ * n;
  S* d_derivatives = d_heights + bins_ * n;
  S* by_z = d_z.data();
  differentiate_elements<S>(by_z, d_log_det.replicate(u.cols(), 1), scratch);
  spread_over_bins(by_z, scratch, d_widths);
  softmax_backward(scratch.widths, d_widths);
  softmax_backward(scratch.heights, d_heights);
  // softplus'(x) = 1 - exp(-softplus(x)).
  Eigen::Map<ColumnMatrixX<S>>(d_derivatives, n, bins_ - 1).array() *=
      S(1) - (S(kSmallestScale) - scratch.derivatives.array()).exp();
  const S *v = scratch.moved.data(), *by_v = scratch.d_element.col(0).data();
#pragma omp simd
  for (Index i = 0; i < n; ++i) by_z[i] = is_inside(v[i]) ? by_v[i] : by_z[i];
  affine_.backward(u, d_log_det, scratch, d_z);
}

// The root of a xi^2 + b xi + c = 0 that lies in [0, 1] (eqs. 6-8), written without cancellation.
template <typename S>
VectorX<S> SplineMap<S>::inverse(const VectorX<S>& z, const ColumnMatrixX<S>& raw) const {
  ElementScratch<S> scratch;
  scratch.raw = raw;
  shape(scratch, 1);
  SplineBins<S>& bin = scratch.bins;
  find_bins<Axis::z>(scratch, z.data(), bin);
  VectorX<S> v(z.size());
  const S *value = z.data(), *knot_v = bin.v.data(), *knot_z = bin.z.data(), *w = bin.w.data(),
          *h = bin.h.data(), *d0 = bin.d0.data(), *d1 = bin.d1.data();
  S* moved = v.data();
#pragma omp simd
  for (Index i = 0; i < z.size(); ++i) {
    const S s = h[i] / w[i], y = value[i] - knot_z[i], bend = d1[i] + d0[i] - 2 * s;
    const S a = h[i] * (s - d0[i]) + y * bend;
    const S b = h[i] * d0[i] - y * bend;
    const S c = -s * y;
    const S root = std::sqrt(std::max(S(0), b * b - 4 * a * c));
    moved[i] = is_inside(value[i]) ? knot_v[i] + w[i] * 2 * c / (-b - root) : value[i];
  }
  return affine_.inverse(v, raw.leftCols(2));
}

template class SplineMap<NPDR_SCALAR>;

}  // namespace npdr::inference
