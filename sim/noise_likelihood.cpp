#include "sim/noise_likelihood.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "core/error.h"
#include "core/normal.h"
#include "sim/noise_transform.h"

namespace npdr::sim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Degrees of freedom beyond which Student's t is taken for one with these: as good as Gaussian,
// while 1 + e^2 / nu still tells e.
constexpr double kMostDegrees = 1e7;
const double kLogTwoPi = std::log(2.0 * std::numbers::pi);

// States are kept in single precision, so none is known better than to this share of the largest.
constexpr double kRounding = 0x1p-24;

// Errors of one channel over a(h, c): those of all states, each beside the one before it. Where the
// scale of their noise may be unknown no likelihood takes them for smaller than the states'
// rounding: a simulation that meets a recording exactly would have an unbounded one.
struct Errors {
  Eigen::ArrayXd now;
  Eigen::ArrayXd before;     // 0 where a segment begins
  double rounding = 0.0;     // its square
  double now_squared = 0.0;  // sums
  double product = 0.0;
  double before_squared = 0.0;
  double log_measure = 0.0;  // log |d y / d error|

  // Sum of (now - rho before)^2.
  double squares(double rho) const {
    const double sum = now_squared - 2.0 * rho * product + rho * rho * before_squared;
    return std::max(sum, static_cast<double>(now.size()) * rounding);
  }
};

// Sum of log(1 + (now - rho before)^2 / spread): of products of eight, unless one overflows.
double log_of_squares(const Errors& errors, double rho, double spread) {
  const auto factors_of = [&](Index first, Index count) {
    const auto now = errors.now.segment(first, count), before = errors.before.segment(first, count);
    return 1.0 + (now - rho * before).square().max(errors.rounding) * (1.0 / spread);
  };
  constexpr Index factors = 8;
  const Index n = errors.now.size() / factors, rest = factors * n;
  Eigen::ArrayXd product = factors_of(0, n);
  for (Index k = 1; k < factors; ++k) product *= factors_of(k * n, n);
  const double sum = product.log().sum() + factors_of(rest, errors.now.size() - rest).log().sum();
  return std::isfinite(sum) ? sum : factors_of(0, errors.now.size()).log().sum();
}

double log_density(const ChannelNoise& noise, const Errors& errors, const NoiseValues& at) {
  const auto n = static_cast<double>(errors.now.size());
  const double rho = at.correlation;
  if (!noise.is_heavy_tailed) {
    return -n * (std::log(at.scale) + 0.5 * kLogTwoPi) -
           0.5 * errors.squares(rho) / (at.scale * at.scale);
  }
  const double nu = std::min(at.degrees_of_freedom, kMostDegrees);
  const double sum = log_of_squares(errors, rho, nu * at.scale * at.scale);
  return n * (log_student_t_density(0.0, nu) - std::log(at.scale)) - 0.5 * (nu + 1.0) * sum;
}

// A Gaussian that touches exp f at its mode.
struct Peak {
  Vector mode;
  Eigen::MatrixXd factor;  // lower, L L^T = (-f'')^-1
};

// The integrand's logarithm f, over the unknown parameters' z.
class Integrand {
 public:
  Integrand(const ChannelNoise& noise, const Errors& errors)
      : noise_(noise), errors_(errors), transform_(noise) {}

  Index dimension() const { return transform_.dimension(); }

  double operator()(const Vector& z) const {
    const double value = log_density(noise_, errors_, transform_.values(z)) -
                         0.5 * z.squaredNorm() - 0.5 * static_cast<double>(z.size()) * kLogTwoPi;
    return std::isnan(value) ? -kInfinity : value;
  }

  NoiseValues values(const Vector& z) const { return transform_.values(z); }

  // Where the moments of the errors put the parameters.
  Vector guess() const;

 private:
  const ChannelNoise& noise_;
  const Errors& errors_;
  NoiseTransform transform_;
};

Vector Integrand::guess() const {
  const auto n = static_cast<double>(errors_.now.size());
  const double ratio = errors_.before_squared > 0.0
                           ? std::clamp(errors_.product / errors_.before_squared, 0.02, 0.98)
                           : 0.5;
  const double rho = noise_.is_correlated ? ratio : 0.0;
  const double tails = noise_.is_heavy_tailed ? 0.7 : 1.0;
  Vector z = Vector::Zero(dimension());
  Index next = 0;
  if (noise_.scale.is_unknown()) {
    const double scale = tails * std::sqrt(errors_.squares(rho) / n);
    z(next++) = std::log(scale / noise_.scale.median) / noise_.scale.deviation;
  }
  if (noise_.is_correlated && noise_.correlation.is_unknown()) {
    const double median = noise_.correlation.median;
    z(next++) =
        std::log(rho / (1.0 - rho) * (1.0 - median) / median) / noise_.correlation.deviation;
  }
  return z;
}

// First and second derivatives of f, by differences.
struct Curve {
  Vector gradient;
  Eigen::MatrixXd inverse;  // of -f'', or of what is next to it and goes down
};

Curve curve_at(const Integrand& f, const Vector& z) {
  constexpr double h = 1e-3;
  const Index k = z.size();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(k, k);
  const double value = f(z);
  Vector gradient(k), up(k);
  Eigen::MatrixXd curvature(k, k);  // -f''
  for (Index i = 0; i < k; ++i) {
    up(i) = f(z + h * identity.col(i));
    const double down = f(z - h * identity.col(i));
    gradient(i) = (up(i) - down) / (2.0 * h);
    curvature(i, i) = -(up(i) - 2.0 * value + down) / (h * h);
    for (Index j = 0; j < i; ++j) {
      const double both = f(z + h * (identity.col(i) + identity.col(j)));
      curvature(i, j) = curvature(j, i) = -(both - up(i) - up(j) + value) / (h * h);
    }
  }
  Eigen::LLT<Eigen::MatrixXd> llt(curvature);
  for (double ridge = 1.0; llt.info() != Eigen::Success && ridge < 1e12; ridge *= 10.0) {
    llt.compute(curvature + ridge * identity);
  }
  return {gradient, llt.solve(identity)};
}

// Goes uphill by as much of `move` as leads there; false: none does.
bool climb(const Integrand& f, Vector move, Vector& z) {
  const double value = f(z);
  for (int halving = 0; halving < 40; ++halving, move *= 0.5) {
    if (!(f(z + move) > value)) continue;
    z += move;
    return true;
  }
  return false;
}

// Newton's method.
Peak find_peak(const Integrand& f) {
  constexpr int most_steps = 30;
  Vector z = f.guess();
  for (int step = 0;; ++step) {
    const Curve curve = curve_at(f, z);
    const Vector move = curve.inverse * curve.gradient;
    const bool is_there = !(curve.gradient.dot(move) > 1e-8);
    if (is_there || step == most_steps || !climb(f, move, z)) {
      return {z, Eigen::LLT<Eigen::MatrixXd>(curve.inverse).matrixL()};
    }
  }
}

// Nodes x and weights of Gauss-Hermite quadrature, for the weight exp(-x^2), by their number of
// dimensions.
struct Quadrature {
  std::span<const double> nodes;
  std::span<const double> weights;
};

constexpr std::array<double, 7> kNodes7 = {
    -2.651961356835233, -1.673551628767471, -0.8162878828589647, 0.0,
    0.8162878828589647, 1.673551628767471,  2.651961356835233};
constexpr std::array<double, 7> kWeights7 = {
    9.717812450995192e-4, 0.05451558281912703, 0.4256072526101278,  0.8102646175568073,
    0.4256072526101278,   0.05451558281912703, 9.717812450995192e-4};
constexpr std::array<double, 5> kNodes5 = {-2.020182870456086, -0.9585724646138185, 0.0,
                                           0.9585724646138185, 2.020182870456086};
constexpr std::array<double, 5> kWeights5 = {0.01995324205904591, 0.3936193231522412,
                                             0.9453087204829419, 0.3936193231522412,
                                             0.01995324205904591};

Quadrature quadrature(Index dimension) {
  if (dimension <= 2) return {kNodes7, kWeights7};
  return {kNodes5, kWeights5};
}

// log of the integral of exp f.
double log_integral(const Integrand& f) {
  const Index k = f.dimension();
  if (k == 0) return f(Vector());
  const Peak peak = find_peak(f);
  const double highest = f(peak.mode);
  if (!std::isfinite(highest)) return -kInfinity;
  const Quadrature rule = quadrature(k);
  const auto per_dimension = static_cast<Index>(rule.nodes.size());
  Index count = 1;
  for (Index d = 0; d < k; ++d) count *= per_dimension;
  double sum = 0.0;
  Vector x(k);
  for (Index i = 0; i < count; ++i) {
    double weight = 1.0;
    for (Index d = 0, rest = i; d < k; ++d, rest /= per_dimension) {
      x(d) = rule.nodes[static_cast<std::size_t>(rest % per_dimension)];
      weight *= rule.weights[static_cast<std::size_t>(rest % per_dimension)];
    }
    const Vector z = peak.mode + std::numbers::sqrt2 * (peak.factor * x);
    sum += weight * std::exp(f(z) - highest + x.squaredNorm());
  }
  return highest + std::log(sum) + 0.5 * static_cast<double>(k) * std::log(2.0) +
         peak.factor.diagonal().array().log().sum();
}

// Errors of channel c in all rollouts but `left_out`.
Errors errors_of(const NoiseModel& model, std::span<const float> recorded,
                 std::span<const float> simulated, Index c, Index left_out) {
  const Index steps = model.num_steps(), states = model.num_states();
  const Index rollouts = model.num_rollouts() - (left_out >= 0 ? 1 : 0);
  Errors errors{Eigen::ArrayXd(rollouts * steps), Eigen::ArrayXd(rollouts * steps)};
  // A scale in the channel's unit is given.
  const bool is_in_unit = model.channels()[static_cast<std::size_t>(c)].is_in_unit;
  errors.rounding = is_in_unit ? 0.0 : kRounding * kRounding;
  Index next = 0;
  for (Index h = 0; h < model.num_rollouts(); ++h) {
    if (h == left_out) continue;
    const double unit = model.unit()(h, c);
    errors.log_measure += static_cast<double>(steps) * std::log(model.measure()(h, c) / unit);
    double last = 0.0;
    for (Index k = 0; k < steps; ++k, ++next) {
      const auto i = static_cast<std::size_t>((h * steps + k) * states + c);
      const double error =
          (static_cast<double>(recorded[i]) - static_cast<double>(simulated[i])) / unit;
      errors.now(next) = error;
      errors.before(next) = model.restarts()[static_cast<std::size_t>(k)] != 0 ? 0.0 : last;
      last = error;
    }
  }
  errors.now_squared = errors.now.square().sum();
  errors.product = (errors.now * errors.before).sum();
  errors.before_squared = errors.before.square().sum();
  return errors;
}

}  // namespace

NoiseLikelihood::NoiseLikelihood(NoiseModel model, std::vector<float> recorded)
    : model_(std::move(model)), recorded_(std::move(recorded)) {
  if (std::ssize(recorded_) != model_.num_rollouts() * model_.num_steps() * model_.num_states()) {
    throw ShapeError("likelihood: " + std::to_string(recorded_.size()) +
                     " recorded values are not those of the noise's rollouts, steps and channels");
  }
}

void NoiseLikelihood::require_density() const {
  for (Index c = 0; c < model_.num_states(); ++c) {
    if (model_.channels()[static_cast<std::size_t>(c)].scale.median == 0.0) {
      throw InputError("likelihood: the noise of channel " + std::to_string(c + 1) +
                       " has scale 0, must be > 0");
    }
    if (!model_.has_density(c)) {
      throw InputError("likelihood: channel " + std::to_string(c + 1) +
                       " is 0 throughout a rollout, so noise relative to it is none; give its "
                       "scale in its unit");
    }
  }
}

double NoiseLikelihood::log_likelihood(std::span<const float> simulated) const {
  return log_likelihood_without(-1, simulated);
}

double NoiseLikelihood::log_likelihood_without(Index left_out,
                                               std::span<const float> simulated) const {
  double sum = 0.0;
  for (Index c = 0; c < model_.num_states(); ++c) {
    const Errors errors = errors_of(model_, recorded_, simulated, c, left_out);
    if (!std::isfinite(errors.now_squared)) return -kInfinity;
    const Integrand f(model_.channels()[static_cast<std::size_t>(c)], errors);
    sum += log_integral(f) + errors.log_measure;
  }
  return std::isnan(sum) ? -kInfinity : sum;
}

std::vector<NoiseValues> NoiseLikelihood::draw_values(std::span<const float> simulated,
                                                      Stream& stream, Index left_out) const {
  std::vector<NoiseValues> values;
  for (Index c = 0; c < model_.num_states(); ++c) {
    const Errors errors = errors_of(model_, recorded_, simulated, c, left_out);
    const Integrand f(model_.channels()[static_cast<std::size_t>(c)], errors);
    Vector z(f.dimension());
    for (double& normal : z) normal = stream.normal();
    if (z.size() > 0 && model_.has_density(c)) {
      const Peak peak = find_peak(f);
      z = peak.mode + peak.factor * z;
    }
    values.push_back(f.values(z));
  }
  return values;
}

}  // namespace npdr::sim
