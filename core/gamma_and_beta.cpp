#include "core/gamma_and_beta.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/SpecialFunctions>

#include "core/constants.h"

namespace npdr {
namespace {

constexpr double kSmallest = std::numeric_limits<double>::min();

// The t with log_tail(t) = log p. slope(t): of log_tail, whose sign doesn't change.
template <class LogTail, class Slope>
double solve(const LogTail& log_tail, const Slope& slope, double p, double low, double high) {
  constexpr int most_steps = 200;
  constexpr double exact = 1e-15;
  const double wanted = std::log(p);
  const bool rises = log_tail(high) > log_tail(low);
  double t = std::clamp(0.0, low, high);
  for (int i = 0; i < most_steps && high - low > exact * std::max(1.0, std::abs(t)); ++i) {
    const double missing = wanted - log_tail(t);
    if (missing == 0.0) break;
    (rises == (missing > 0.0) ? low : high) = t;
    const double next = t + missing / slope(t);
    const bool is_between = next > low && next < high;  // not of NaN
    if (is_between && std::abs(next - t) <= exact * std::max(1.0, std::abs(t))) return next;
    t = is_between && i % 4 != 3 ? next : 0.5 * (low + high);
  }
  return t;
}

// x of its logit, and what is left of 1.
double expit(double t) { return 1.0 / (1.0 + std::exp(-t)); }

double log_beta_function(double a, double b) {
  return std::lgamma(a) + std::lgamma(b) - std::lgamma(a + b);
}

}  // namespace

double gamma_tail(double shape, double x, Tail tail) {
  if (x <= 0.0) return tail == Tail::lower ? 0.0 : 1.0;
  if (x == kInfinity) return tail == Tail::lower ? 1.0 : 0.0;
  return tail == Tail::lower ? Eigen::numext::igamma(shape, x) : Eigen::numext::igammac(shape, x);
}

double beta_tail(double a, double b, double x, Tail tail) {
  if (x <= 0.0) return tail == Tail::lower ? 0.0 : 1.0;
  if (x >= 1.0) return tail == Tail::lower ? 1.0 : 0.0;
  const double lower = Eigen::numext::betainc(a, b, x);
  if (tail == Tail::lower) return lower;
  return lower < 0.5 ? 1.0 - lower : Eigen::numext::betainc(b, a, 1.0 - x);
}

double gamma_quantile(double shape, double p, Tail tail) {
  const double sign = tail == Tail::lower ? 1.0 : -1.0;
  const auto log_tail = [&](double t) { return std::log(gamma_tail(shape, std::exp(t), tail)); };
  const auto slope = [&](double t) {
    return sign * std::exp(log_gamma_density(shape, std::exp(t)) + t - log_tail(t));
  };
  return std::max(kSmallest, std::exp(solve(log_tail, slope, p, std::log(kSmallest), 20.0)));
}

double beta_quantile(double a, double b, double p, Tail tail) {
  constexpr double least = -700.0, most = 36.0;  // expit(36) < 1
  const double sign = tail == Tail::lower ? 1.0 : -1.0;
  const auto log_tail = [&](double t) { return std::log(beta_tail(a, b, expit(t), tail)); };
  const auto slope = [&](double t) {
    const double x = expit(t);
    return sign * std::exp(log_beta_density(a, b, x) - log_tail(t)) * x * (1.0 - x);
  };
  return std::clamp(expit(solve(log_tail, slope, p, least, most)), kSmallest, 1.0 - 0x1p-53);
}

double log_gamma_density(double shape, double x) {
  if (!(x > 0.0)) return -kInfinity;
  return (shape - 1.0) * std::log(x) - x - std::lgamma(shape);
}

double log_beta_density(double a, double b, double x) {
  if (!(x > 0.0 && x < 1.0)) return -kInfinity;
  return (a - 1.0) * std::log(x) + (b - 1.0) * std::log1p(-x) - log_beta_function(a, b);
}

}  // namespace npdr
