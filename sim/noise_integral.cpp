#include "sim/noise_integral.h"

#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "core/constants.h"
#include "core/decompositions.h"

namespace npdr::sim {
namespace {

// First and second derivatives of f, by differences.
struct Curve {
  Vector gradient;
  Eigen::MatrixXd inverse;  // of -f'', or of what is next to it and goes down
};

Curve curve_at(const LogIntegrand& f, const Vector& z) {
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
  // Beside an end of what is possible: as the prior N(0, I) is.
  if (!curvature.allFinite() || !gradient.allFinite()) return {Vector::Zero(k), identity};
  Cholesky factor(curvature);
  for (double ridge = 1.0; !factor.is_positive_definite() && ridge < 1e12; ridge *= 10.0) {
    factor = Cholesky(curvature + ridge * identity);
  }
  return {gradient, factor.inverse()};
}

// Goes uphill by as much of `move` as leads there; false: none does.
bool climb(const LogIntegrand& f, Vector move, Vector& z) {
  const double value = f(z);
  for (int halving = 0; halving < 40; ++halving, move *= 0.5) {
    if (!(f(z + move) > value)) continue;
    z += move;
    return true;
  }
  return false;
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
constexpr std::array<double, 1> kNodes1 = {0.0};
const std::array<double, 1> kWeights1 = {std::sqrt(std::numbers::pi)};

Quadrature quadrature(Index dimension) {
  if (dimension <= 2) return {kNodes7, kWeights7};
  if (dimension == 3) return {kNodes5, kWeights5};
  return {kNodes1, kWeights1};
}

// Midpoints of equal parts of [-5, 5]: for integrands that end somewhere.
class MidpointRule {
 public:
  explicit MidpointRule(Index dimension)
      : nodes_(dimension == 1 ? 400 : 40), weights_(nodes_.size()) {
    const double width = 10.0 / static_cast<double>(nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      nodes_[i] = -5.0 + width * (static_cast<double>(i) + 0.5);
      weights_[i] = width * std::exp(-nodes_[i] * nodes_[i]);
    }
  }
  Quadrature quadrature() const { return {nodes_, weights_}; }

 private:
  std::vector<double> nodes_, weights_;
};

struct Sum {
  double value;
  bool is_cut;  // the integrand is 0 at a node
};

// Of exp(f - highest) over all combinations of the rule's nodes.
Sum sum_of_nodes(const LogIntegrand& f, const Peak& peak, double highest, const Quadrature& rule) {
  const Index k = peak.mode.size();
  const auto per_dimension = static_cast<Index>(rule.nodes.size());
  Index count = 1;
  for (Index d = 0; d < k; ++d) count *= per_dimension;
  Sum sum = {0.0, false};
  Vector x(k);
  for (Index i = 0; i < count; ++i) {
    double weight = 1.0;
    for (Index d = 0, rest = i; d < k; ++d, rest /= per_dimension) {
      x(d) = rule.nodes[static_cast<std::size_t>(rest % per_dimension)];
      weight *= rule.weights[static_cast<std::size_t>(rest % per_dimension)];
    }
    const double value = f(peak.mode + std::numbers::sqrt2 * (peak.factor * x));
    sum.value += weight * std::exp(value - highest + x.squaredNorm());
    sum.is_cut = sum.is_cut || value == -kInfinity;
  }
  return sum;
}

}  // namespace

Peak find_peak(const LogIntegrand& f, const Vector& guess) {
  constexpr int most_steps = 30;
  Vector z = guess;
  for (int step = 0;; ++step) {
    const Curve curve = curve_at(f, z);
    const Vector move = curve.inverse * curve.gradient;
    const bool is_there = !(curve.gradient.dot(move) > 1e-8);
    if (is_there || step == most_steps || !climb(f, move, z)) {
      return {z, Cholesky(curve.inverse).lower()};
    }
  }
}

double log_integral(const LogIntegrand& f, const Vector& guess) {
  const Index k = guess.size();
  if (k == 0) return f(Vector());
  const Peak peak = find_peak(f, guess);
  const double highest = f(peak.mode);
  if (!std::isfinite(highest)) return -kInfinity;
  Sum sum = sum_of_nodes(f, peak, highest, quadrature(k));
  if (sum.is_cut && k < 3) sum = sum_of_nodes(f, peak, highest, MidpointRule(k).quadrature());
  return highest + std::log(sum.value) + 0.5 * static_cast<double>(k) * std::log(2.0) +
         peak.factor.diagonal().array().log().sum();
}

}  // namespace npdr::sim
