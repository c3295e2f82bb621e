/// Both tails of the gamma and the beta distribution, and the values that cut them off.
///
/// With x of shape k and scale 1, or of exponents a and b in [0, 1], the lower tail is the
/// regularized incomplete function P(k, x) or I_x(a, b), and the upper one what is left of 1,
/// accurate where it is small (DLMF 8.2, 8.17).
#pragma once

namespace npdr {

enum class Tail { lower, upper };

/// Shapes and exponents are in this range: tails are accurate to 1e-12 or so there.
inline constexpr double kLeastShape = 0.1, kMostShape = 1000.0;

/// P(X <= x), or P(X > x).
double gamma_tail(double shape, double x, Tail tail);
double beta_tail(double a, double b, double x, Tail tail);

/// The x with that tail, 0 < p < 1, by Newton's method for log p over log x, or over logit x, with
/// bisection; the nearest positive double, and one below 1 of beta, where there is no closer.
double gamma_quantile(double shape, double p, Tail tail);
double beta_quantile(double a, double b, double p, Tail tail);

/// log of the densities [nats]; -infinity outside of x > 0, of 0 < x < 1.
double log_gamma_density(double shape, double x);
double log_beta_density(double a, double b, double x);

}  // namespace npdr
