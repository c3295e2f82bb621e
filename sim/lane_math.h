/// Elementary functions in double precision for loops over lanes.
///
/// No branches, no tables and no library calls: GCC turns a `#pragma omp simd` loop over them into
/// full vector instructions (AVX-512, AVX2 or SSE2), and every lane gets the same bits. The
/// polynomials are those of Sun's fdlibm 5.3 (k_sin.c, k_cos.c, e_exp.c), minimax to 2^-58.
#pragma once

#include <bit>
#include <cstdint>

#include "core/constants.h"

namespace npdr::sim {

struct SinCos {
  double sin;
  double cos;
};

/// Largest |x| whose sine and cosine are computed (2^19 pi/2). A joint angle that has turned this
/// far belongs to a rollout that diverged.
inline constexpr double kLargestAngle = 823549.0;

namespace detail {

// Adding 1.5 * 2^52 rounds |v| < 2^51 to an integer, which then sits in the sum's low bits.
inline constexpr double kRoundToInteger = 0x1.8p52;

inline double bits_to_double(std::uint64_t bits) { return std::bit_cast<double>(bits); }
inline std::uint64_t double_to_bits(double x) { return std::bit_cast<std::uint64_t>(x); }

/// sin(x + tail) for |x| <= pi/4.
inline double sin_kernel(double x, double tail) {
  const double z = x * x;
  const double v = z * x;
  const double r = 8.33333333332248946124e-03 +
                   z * (-1.98412698298579493134e-04 +
                        z * (2.75573137070700676789e-06 +
                             z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
  return x - ((z * (0.5 * tail - v * r) - tail) - v * -1.66666666666666324348e-01);
}

/// cos(x + tail) for |x| <= pi/4.
inline double cos_kernel(double x, double tail) {
  const double z = x * x;
  const double r =
      z * (4.16666666666666019037e-02 +
           z * (-1.38888888888741095749e-03 +
                z * (2.48015872894767294178e-05 +
                     z * (-2.75573143513906633035e-07 +
                          z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
  const double half = 0.5 * z;
  const double w = 1.0 - half;
  return w + (((1.0 - w) - half) + (z * r - x * tail));
}

/// P(z) of e_exp.c: r (exp(r) + 1) / (exp(r) - 1) = 2 + z P(z) with z = r^2, |r| <= ln(2) / 2.
inline double expm1_polynomial(double z) {
  return 1.66666666666666019037e-01 +
         z * (-2.77777777770155933842e-03 +
              z * (6.61375632143793436117e-05 +
                   z * (-1.65339022054652515390e-06 + z * 4.13813679705723846039e-08)));
}

}  // namespace detail

/// Sine and cosine of x [rad] to about 1 ulp for |x| <= kLargestAngle; NaN beyond and for NaN.
inline SinCos lane_sincos(double x) {
  using namespace detail;
  const double angle = ((x <= kLargestAngle) & (x >= -kLargestAngle)) ? x : kNaN;
  // Cody and Waite: x = n pi/2 + hi + lo. The first two parts of pi/2 have 33 bits, so that their
  // products with n < 2^20 are exact; the third has the next 53.
  const double shifted = angle * 6.36619772367581382433e-01 + kRoundToInteger;
  const double n = shifted - kRoundToInteger;
  const double r1 = angle - n * 1.57079632673412561417e+00;
  const double w2 = n * 6.07710050630396597660e-11;
  const double r2 = r1 - w2;
  const double w3 = n * 2.02226624879595063154e-21 - ((r1 - r2) - w2);
  const double hi = r2 - w3;
  const double lo = (r2 - hi) - w3;

  const std::uint64_t s = double_to_bits(sin_kernel(hi, lo));
  const std::uint64_t c = double_to_bits(cos_kernel(hi, lo));
  const std::uint64_t quadrant = double_to_bits(shifted);
  const std::uint64_t swap = std::uint64_t{0} - (quadrant & 1);
  const std::uint64_t sin_sign = (quadrant & 2) << 62;
  const std::uint64_t cos_sign = ((quadrant + 1) & 2) << 62;
  return {bits_to_double(((s & ~swap) | (c & swap)) ^ sin_sign),
          bits_to_double(((c & ~swap) | (s & swap)) ^ cos_sign)};
}

/// x [rad] minus the whole turns nearest to it: within [-pi, pi], up to rounding.
inline double lane_wrap(double x) {
  const double shifted = x * 1.59154943091895345608e-01 + detail::kRoundToInteger;
  return x - (shifted - detail::kRoundToInteger) * 6.28318530717958623200e+00;
}

/// Exponential to within 1 ulp for -708 <= x <= 709; 0 below, infinity above, NaN for NaN.
///
/// With x = k ln 2 + r and c = r - r^2 P(r^2): exp(x) = 2^k (1 + (r + r c / (2 - c))).
inline double lane_exp(double x) {
  using namespace detail;
  const double a = x < -708.0 ? -708.0 : (x > 709.0 ? 709.0 : x);
  const double shifted = a * 1.44269504088896338700e+00 + kRoundToInteger;
  const double k = shifted - kRoundToInteger;
  const double hi = a - k * 6.93147180369123816490e-01;
  const double lo = k * 1.90821492927058770002e-10;
  const double r = hi - lo;

  const double c = r - r * r * expm1_polynomial(r * r);
  const double value = 1.0 - ((lo - r * c / (2.0 - c)) - hi);
  const double scaled = value * bits_to_double((double_to_bits(shifted) + 1023) << 52);
  return x < -708.0 ? 0.0 : (x > 709.0 ? kInfinity : scaled);
}

/// Hyperbolic tangent to within 4 ulp, NaN for NaN.
///
/// With 2|x| = k ln 2 + r and expm1(r) = 2r / q, q = 2 - r + r^2 P(r^2):
///   tanh|x| = expm1(2|x|) / (expm1(2|x|) + 2)
///           = (2^(k+1) r + (2^k - 1) q) / (2^(k+1) r + (2^k + 1) q).
inline double lane_tanh(double x) {
  using namespace detail;
  constexpr std::uint64_t sign_bit = std::uint64_t{1} << 63;
  const std::uint64_t sign = double_to_bits(x) & sign_bit;
  const double twice = 2.0 * bits_to_double(double_to_bits(x) ^ sign);
  const double a = twice > 44.0 ? 44.0 : twice;  // tanh(22) rounds to 1
  const double shifted = a * 1.44269504088896338700e+00 + kRoundToInteger;
  const double k = shifted - kRoundToInteger;
  const double r = (a - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;

  const double z = r * r;
  const double q = 2.0 - (r - z * expm1_polynomial(z));
  // The low bits of `shifted` are k; adding the bias and shifting makes 2^k.
  const double power = bits_to_double((double_to_bits(shifted) + 1023) << 52);
  const double common = 2.0 * power * r;
  const double value = (common + (power - 1.0) * q) / (common + (power + 1.0) * q);
  return bits_to_double(double_to_bits(value) ^ sign);
}

}  // namespace npdr::sim
