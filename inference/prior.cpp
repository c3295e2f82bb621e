#include "inference/prior.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "core/constants.h"
#include "core/error.h"
#include "core/normal.h"
#include "inference/standard_normal.h"

namespace npdr::inference {
namespace {

// Probabilities stay this far from 0 and 1, so that u stays finite (|u| < 8.3).
constexpr double kSmallestProbability = 0x1p-53;
constexpr double kSmallestPositive = std::numeric_limits<double>::min();
constexpr double kLargest = std::numeric_limits<double>::max();

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

double log_density(const Marginal& m, double theta) {
  switch (m.kind) {
    case Marginal::Kind::uniform:
      return theta >= m.a && theta <= m.b ? -std::log(m.b - m.a) : -kInfinity;
    case Marginal::Kind::log_uniform:
      return theta >= m.a && theta <= m.b ? -std::log(theta * log_ratio(m.b, m.a)) : -kInfinity;
    case Marginal::Kind::normal:
      return log_normal_density((theta - m.a) / m.b) - std::log(m.b);
    case Marginal::Kind::log_normal:
      if (!(theta > 0.0)) return -kInfinity;
      return log_normal_density((std::log(theta) - m.a) / m.b) - std::log(theta) - std::log(m.b);
  }
  return -kInfinity;
}

double to_normal(const Marginal& m, double theta) {
  if (m.kind == Marginal::Kind::normal) return (theta - m.a) / m.b;
  if (m.kind == Marginal::Kind::log_normal) {
    return theta > 0.0 ? (std::log(theta) - m.a) / m.b : normal_quantile(kSmallestProbability);
  }
  const double p = std::clamp(cdf(m, theta), kSmallestProbability, 1.0 - kSmallestProbability);
  return normal_quantile(p);
}

double to_theta(const Marginal& m, double u) {
  if (!std::isfinite(u)) return kNaN;  // not the border
  if (m.kind == Marginal::Kind::normal) return m.a + m.b * u;
  if (m.kind == Marginal::Kind::log_normal) {
    return std::clamp(std::exp(m.a + m.b * u), kSmallestPositive, kLargest);
  }
  return quantile(m, normal_cdf(u));
}

}  // namespace

double Marginal::lower() const {
  if (kind == Kind::log_normal) return 0.0;
  return kind == Kind::normal ? -kInfinity : a;
}

double Marginal::upper() const { return is_unbounded() ? kInfinity : b; }

bool Marginal::is_log() const { return kind == Kind::log_uniform || kind == Kind::log_normal; }

bool Marginal::is_unbounded() const { return kind == Kind::normal || kind == Kind::log_normal; }

std::pair<double, double> Marginal::central_range(double u) const {
  if (!is_unbounded()) return {a, b};
  return {inference::to_theta(*this, -u), inference::to_theta(*this, u)};
}

bool Marginal::overflows() const {
  if (kind == Kind::uniform) return !std::isfinite(b - a);
  if (kind == Kind::log_uniform) return !std::isfinite(b * log_ratio(b, a));
  const auto [smallest, largest] = central_range(9.0);
  if (kind == Kind::normal) return !std::isfinite(smallest) || !std::isfinite(largest);
  return smallest <= kSmallestPositive || largest >= kLargest;
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
