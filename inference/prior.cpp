#include "inference/prior.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "core/constants.h"
#include "core/error.h"
#include "core/gamma_and_beta.h"
#include "core/normal.h"
#include "inference/standard_normal.h"

namespace npdr::inference {
namespace {

// Probabilities stay this far from 0 and 1, so that u stays finite (|u| < 8.3).
constexpr double kSmallestProbability = 0x1p-53;
constexpr double kSmallestPositive = std::numeric_limits<double>::min();
constexpr double kLargest = std::numeric_limits<double>::max();
constexpr double kSmallestScale = 1e-100;  // of a gamma

[[noreturn]] void reject(const Marginal& m, const std::string& rule) {
  std::ostringstream message;
  message << "prior." << m.name << " = [" << m.a << ", " << m.b << "], " << rule;
  throw InputError(message.str());
}

void check(const Marginal& m) {
  if (!std::isfinite(m.a) || !std::isfinite(m.b)) reject(m, "must be finite");
  switch (m.kind) {
    case Marginal::Kind::uniform:
      if (m.a >= m.b) reject(m, "the lower bound must be smaller than the upper bound");
      if (m.overflows()) reject(m, "the width must be within the range of double");
      break;
    case Marginal::Kind::log_uniform:
      if (m.a <= 0.0) reject(m, "bounds of a log_uniform prior must be > 0");
      if (m.a >= m.b) reject(m, "the lower bound must be smaller than the upper bound");
      if (m.overflows()) reject(m, "the width must be within the range of double");
      break;
    case Marginal::Kind::normal:
    case Marginal::Kind::log_normal:
      if (m.b <= 0.0) reject(m, "the standard deviation must be > 0");
      if (m.overflows()) reject(m, "theta of mean +- 9 std must be within the range of double");
      break;
    case Marginal::Kind::beta:
      if (!(m.b >= kLeastShape && m.b <= kMostShape)) reject(m, "b must be 0.1 to 1000");
      [[fallthrough]];
    case Marginal::Kind::gamma:
      if (!(m.a >= kLeastShape && m.a <= kMostShape)) reject(m, "a must be 0.1 to 1000");
      if (!(m.b >= kSmallestScale && m.b <= 1.0 / kSmallestScale)) reject(m, "b is out of range");
      break;
  }
  if (m.is_cut() && !(!m.is_uniform() && m.mass() >= Marginal::kLeastMass)) {
    reject(m, "hardly anything is left between its ends");
  }
}

// log(b / a), also where the ratio leaves the range of double.
double log_ratio(double b, double a) {
  const double ratio = b / a;
  return std::isfinite(ratio) ? std::log(ratio) : std::log(b) - std::log(a);
}

// a (b / a)^p, likewise.
double between_logs(double a, double b, double p) {
  const double ratio = b / a;
  return std::isfinite(ratio) ? a * std::pow(ratio, p)
                              : std::exp(std::log(a) + p * log_ratio(b, a));
}

// Distribution function of a bounded marginal, its inverse and its log density.
double cdf(const Marginal& m, double theta) {
  if (theta <= m.a) return 0.0;
  if (m.kind == Marginal::Kind::log_uniform) return log_ratio(theta, m.a) / log_ratio(m.b, m.a);
  return (theta - m.a) / (m.b - m.a);
}

double quantile(const Marginal& m, double p) {
  const double theta =
      m.kind == Marginal::Kind::log_uniform ? between_logs(m.a, m.b, p) : m.a + p * (m.b - m.a);
  return std::clamp(theta, m.a, m.b);  // rounding must not leave the support
}

// P(X <= theta), or P(X > theta), of a marginal that isn't uniform and isn't cut off.
double tail_of(const Marginal& m, double theta, Tail tail) {
  using enum Marginal::Kind;
  if (m.kind == gamma) return gamma_tail(m.a, theta / m.b, tail);
  if (m.kind == beta) return beta_tail(m.a, m.b, theta, tail);
  if (m.kind == log_normal && theta <= 0.0) return tail == Tail::lower ? 0.0 : 1.0;
  const double u = ((m.kind == log_normal ? std::log(theta) : theta) - m.a) / m.b;
  return normal_cdf(tail == Tail::lower ? u : -u);
}

double value_at(const Marginal& m, double p, Tail tail) {
  using enum Marginal::Kind;
  if (m.kind == gamma) return m.b * gamma_quantile(m.a, p, tail);
  if (m.kind == beta) return beta_quantile(m.a, m.b, p, tail);
  const double t = m.a + m.b * (tail == Tail::lower ? 1.0 : -1.0) * normal_quantile(p);
  return m.kind == log_normal ? std::exp(t) : t;
}

// Of marginals without such ends u is a linear function, of theta or its logarithm.
bool is_linear(const Marginal& m) {
  return (m.kind == Marginal::Kind::normal || m.kind == Marginal::Kind::log_normal) && !m.is_cut();
}

// u by the smaller one of both tails, which is the more accurate one.
double normal_by_tails(const Marginal& m, double theta) {
  const auto share = [&](Tail tail, double end) {
    const double p = (tail_of(m, theta, tail) - tail_of(m, end, tail)) / m.mass();
    return normal_quantile(std::clamp(p, kSmallestProbability, 1.0 - kSmallestProbability));
  };
  const double u = share(Tail::lower, m.from);
  return u < 0.0 ? u : -share(Tail::upper, m.to);
}

double theta_by_tails(const Marginal& m, double u) {
  const Tail tail = u < 0.0 ? Tail::lower : Tail::upper;
  const double p = std::max(normal_cdf(-std::abs(u)), kSmallestProbability) * m.mass();
  const double cut = tail_of(m, tail == Tail::lower ? m.from : m.to, tail);
  return std::clamp(value_at(m, cut + p, tail), std::max(m.lower(), -kLargest),
                    std::min(m.upper(), kLargest));
}

double log_density(const Marginal& m, double theta) {
  using enum Marginal::Kind;
  if (!(theta >= m.lower() && theta <= m.upper())) return -kInfinity;
  if (m.kind == uniform) return -std::log(m.b - m.a);
  if (m.kind == log_uniform) return -std::log(theta * log_ratio(m.b, m.a));
  const double cut = m.is_cut() ? std::log(m.mass()) : 0.0;
  if (m.kind == gamma) return log_gamma_density(m.a, theta / m.b) - std::log(m.b) - cut;
  if (m.kind == beta) return log_beta_density(m.a, m.b, theta) - cut;
  if (m.kind == normal) return log_normal_density((theta - m.a) / m.b) - std::log(m.b) - cut;
  if (!(theta > 0.0)) return -kInfinity;
  return log_normal_density((std::log(theta) - m.a) / m.b) - std::log(theta) - std::log(m.b) - cut;
}

double to_normal(const Marginal& m, double theta) {
  if (!m.is_uniform() && !is_linear(m)) return normal_by_tails(m, theta);
  if (m.kind == Marginal::Kind::normal) return (theta - m.a) / m.b;
  if (m.kind == Marginal::Kind::log_normal) {
    return theta > 0.0 ? (std::log(theta) - m.a) / m.b : normal_quantile(kSmallestProbability);
  }
  const double p = std::clamp(cdf(m, theta), kSmallestProbability, 1.0 - kSmallestProbability);
  return normal_quantile(p);
}

double to_theta(const Marginal& m, double u) {
  if (!std::isfinite(u)) return kNaN;  // not the border
  if (!m.is_uniform() && !is_linear(m)) return theta_by_tails(m, u);
  if (m.kind == Marginal::Kind::normal) return m.a + m.b * u;
  if (m.kind == Marginal::Kind::log_normal) {
    return std::clamp(std::exp(m.a + m.b * u), kSmallestPositive, kLargest);
  }
  return quantile(m, normal_cdf(u));
}

}  // namespace

double Marginal::lower() const {
  if (is_uniform()) return a;
  return std::max(from, kind == Kind::normal ? -kInfinity : 0.0);
}

double Marginal::upper() const {
  if (is_uniform()) return b;
  return std::min(to, kind == Kind::beta ? 1.0 : kInfinity);
}

bool Marginal::is_log() const { return kind == Kind::log_uniform || kind == Kind::log_normal; }

bool Marginal::is_uniform() const { return kind == Kind::uniform || kind == Kind::log_uniform; }

bool Marginal::is_cut() const { return from > -kInfinity || to < kInfinity; }

std::pair<double, double> Marginal::central_range(double u) const {
  if (is_uniform()) return {a, b};
  return {inference::to_theta(*this, -u), inference::to_theta(*this, u)};
}

bool Marginal::overflows() const {
  if (kind == Kind::uniform) return !std::isfinite(b - a);
  if (kind == Kind::log_uniform) return !std::isfinite(b * log_ratio(b, a));
  if (kind == Kind::gamma || kind == Kind::beta) return false;
  Marginal whole = *this;
  whole.from = -kInfinity;
  whole.to = kInfinity;
  const auto [smallest, largest] = whole.central_range(9.0);
  if (kind == Kind::normal) return !std::isfinite(smallest) || !std::isfinite(largest);
  return smallest <= kSmallestPositive || largest >= kLargest;
}

double Marginal::mass() const {
  if (!is_cut()) return 1.0;
  const bool is_above = tail_of(*this, from, Tail::lower) > 0.5;
  return is_above ? tail_of(*this, from, Tail::upper) - tail_of(*this, to, Tail::upper)
                  : tail_of(*this, to, Tail::lower) - tail_of(*this, from, Tail::lower);
}

Prior::Prior(std::vector<Marginal> marginals) : marginals_(std::move(marginals)) {
  if (marginals_.empty()) throw InputError("prior: has no parameter, must have at least one");
  std::set<std::string> names;
  for (const Marginal& m : marginals_) {
    check(m);
    if (!names.insert(m.name).second) throw InputError("prior." + m.name + ": given twice");
  }
}

Vector Prior::sample(Stream& stream) const {
  RowMatrix u(1, dimension());
  for (Index d = 0; d < dimension(); ++d) u(0, d) = stream.normal();
  return to_theta(u).row(0).transpose();
}

Vector Prior::log_prob(const RowMatrix& theta) const {
  if (theta.cols() != dimension()) throw ShapeError("Prior::log_prob: theta has the wrong width");
  Vector result = Vector::Zero(theta.rows());
  for (Index i = 0; i < theta.rows(); ++i) {
    for (Index d = 0; d < dimension(); ++d) {
      result(i) += log_density(marginals_[static_cast<std::size_t>(d)], theta(i, d));
    }
  }
  return result;
}

RowMatrix Prior::to_normal(const RowMatrix& theta) const {
  if (theta.cols() != dimension()) throw ShapeError("Prior::to_normal: theta has the wrong width");
  RowMatrix u(theta.rows(), dimension());
  for (Index i = 0; i < theta.rows(); ++i) {
    for (Index d = 0; d < dimension(); ++d) {
      u(i, d) = inference::to_normal(marginals_[static_cast<std::size_t>(d)], theta(i, d));
    }
  }
  return u;
}

RowMatrix Prior::to_theta(const RowMatrix& u) const {
  if (u.cols() != dimension()) throw ShapeError("Prior::to_theta: u has the wrong width");
  RowMatrix theta(u.rows(), dimension());
  for (Index i = 0; i < u.rows(); ++i) {
    for (Index d = 0; d < dimension(); ++d) {
      theta(i, d) = inference::to_theta(marginals_[static_cast<std::size_t>(d)], u(i, d));
    }
  }
  return theta;
}

Vector Prior::log_det_to_normal(const RowMatrix& theta) const {
  const RowMatrix u = to_normal(theta);
  return log_prob(theta) - log_standard_normal(u);
}

bool Prior::contains(const Vector& theta) const {
  for (Index d = 0; d < dimension(); ++d) {
    const double log_prob = log_density(marginals_[static_cast<std::size_t>(d)], theta(d));
    if (!(log_prob > -kInfinity)) return false;
  }
  return true;
}

RowMatrix sample_prior(const Prior& prior, Index n, StreamId id) {
  RowMatrix theta(n, prior.dimension());
  for (Index i = 0; i < n; ++i) {
    id.row = static_cast<std::uint64_t>(i);
    Stream stream(id);
    theta.row(i) = prior.sample(stream).transpose();
  }
  return theta;
}

RowMatrix sample_prior(const Prior& prior, Index n, std::uint64_t seed, std::uint64_t round) {
  return sample_prior(prior, n, {seed, "prior", round, 0, 0});
}

}  // namespace npdr::inference
