/// Prior over the domain parameters and the map that makes it standard normal.
///
/// Every marginal is independent. With F_d the distribution function of marginal d,
///   u_d = Phi^-1(F_d(theta_d)),      theta_d = F_d^-1(Phi(u_d)),
/// turns the prior into N(0, I), whatever the marginals. Inference works on u: the support of theta
/// is all of R^D there, so no sample can leave the prior; a flow that starts as the identity starts
/// as the prior; and the Gaussian algebra of the proposal corrections (NPE-A, NPE-C with a mixture
/// of Gaussians) is exact, because the prior is Gaussian. Densities transform as
///   log p(theta) = log p(u) + sum_d [ log p_d(theta_d) - log phi(u_d) ].
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/constants.h"
#include "core/enum_names.h"
#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// Ends of a marginal that are limits of the parameter itself, such as 0 of a friction.
enum class PhysicalEnds { none, lower, upper, both };

constexpr auto enum_table(PhysicalEnds) {
  using enum PhysicalEnds;
  return std::to_array<EnumRow<PhysicalEnds>>(
      {{none, "none"}, {lower, "lower"}, {upper, "upper"}, {both, "both"}});
}

/// One independent marginal of the prior.
struct Marginal {
  static constexpr double kLeastMass = 1e-3;  ///< that may be left between `from` and `to`

  enum class Kind { uniform, log_uniform, normal, log_normal, gamma, beta };

  std::string name;
  std::string unit;
  Kind kind = Kind::uniform;
  /// Lower bound; the mean of a normal theta, or of log theta for a log_normal; the shape of a
  /// gamma; the exponents of a beta, whose density is theta^(a - 1) (1 - theta)^(b - 1) / B(a, b).
  double a = 0.0;
  double b = 1.0;  ///< upper bound; the standard deviation of the same; the scale of a gamma
  PhysicalEnds physical = PhysicalEnds::none;  ///< no density depends on it
  double from = -kInfinity;  ///< with `to`: where a marginal that isn't uniform is cut off
  double to = kInfinity;

  double lower() const;  ///< no theta below has positive density; may be -infinity
  double upper() const;

  /// Whether theta is uniform or normal in its logarithm.
  bool is_log() const;
  /// Whether theta or its logarithm is uniform.
  bool is_uniform() const;
  bool is_cut() const;
  /// [theta(-u), theta(u)], or the bounds where it is uniform.
  std::pair<double, double> central_range(double u) const;
  /// Whether what is computed of it leaves the range of double: the width of a uniform one, or
  /// theta(u) of a normal or log_normal one for any |u| < 9.
  bool overflows() const;
  /// Probability between `from` and `to` of the marginal that isn't cut off.
  double mass() const;
};

constexpr auto enum_table(Marginal::Kind) {
  using enum Marginal::Kind;
  return std::to_array<EnumRow<Marginal::Kind>>({{uniform, "uniform"},
                                                 {log_uniform, "log_uniform", "loguniform"},
                                                 {normal, "normal", "gaussian"},
                                                 {log_normal, "log_normal", "lognormal"},
                                                 {gamma, "gamma"},
                                                 {beta, "beta"}});
}

/// Product of independent marginals. Const calls are thread-safe.
class Prior {
 public:
  /// Throws InputError when a marginal is impossible (low >= high, deviation <= 0, log of <= 0,
  /// not finite, overflows(), shapes out of range, hardly any mass()) or a name occurs twice: says
  /// which.
  explicit Prior(std::vector<Marginal> marginals);

  Index dimension() const { return static_cast<Index>(marginals_.size()); }
  const std::vector<Marginal>& marginals() const { return marginals_; }

  /// theta = to_theta(u) with u ~ N(0, I).
  Vector sample(Stream& stream) const;

  /// log p(theta) in nats; -infinity outside of the support. theta: (n, D); returns (n).
  Vector log_prob(const RowMatrix& theta) const;

  /// u(theta), (n, D). On or outside of the support's border u is the nearest finite value (about
  /// +-8.2), which the prior passes with probability 1e-16.
  RowMatrix to_normal(const RowMatrix& theta) const;

  /// theta(u), (n, D); always inside of the support, and NaN where u isn't finite.
  RowMatrix to_theta(const RowMatrix& u) const;

  /// sum_d log |d u_d / d theta_d| = log p(theta) - log N(u; 0, I) at u = u(theta). (n)
  Vector log_det_to_normal(const RowMatrix& theta) const;

  /// Whether theta (D) lies in the support.
  bool contains(const Vector& theta) const;

 private:
  std::vector<Marginal> marginals_;
};

/// (n, D) draws of the prior; row i has the stream `id` with that row.
RowMatrix sample_prior(const Prior& prior, Index n, StreamId id);
/// (n, D) draws of theta from the stream (seed, "prior", round).
RowMatrix sample_prior(const Prior& prior, Index n, std::uint64_t seed, std::uint64_t round = 1);

}  // namespace npdr::inference
