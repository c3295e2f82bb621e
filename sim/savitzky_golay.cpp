#include "sim/savitzky_golay.h"

#include <string>

#include "core/decompositions.h"
#include "core/error.h"

namespace npdr::sim {
namespace {

// Powers 0 to degree of the window's positions, (window, degree + 1): j / m, which keeps them well
// conditioned.
Eigen::MatrixXd powers_of_positions(Index window, Index degree) {
  const Index m = window / 2;
  Eigen::MatrixXd powers(window, degree + 1);
  for (Index j = 0; j < window; ++j) {
    const double position = static_cast<double>(j - m) / static_cast<double>(m);
    double power = 1.0;
    for (Index k = 0; k <= degree; ++k, power *= position) powers(j, k) = power;
  }
  return powers;
}

// Slopes of the quadratic that fits a window's samples, at each of them.
Vector slopes_of_quadratic(const Eigen::Ref<const Vector>& samples, double dt) {
  const Eigen::MatrixXd powers = powers_of_positions(samples.size(), 2);
  const Vector fit = least_squares(powers, Vector(samples));
  const Index m = samples.size() / 2;
  return (fit(1) + 2.0 * fit(2) * powers.col(1).array()) / (static_cast<double>(m) * dt);
}

}  // namespace

SavitzkyGolay savitzky_golay(Index window, Index degree, double dt) {
  if (window % 2 == 0 || window <= degree + 1) {
    throw InputError("smoothing window = " + std::to_string(window) +
                     " states, must be odd and > " + std::to_string(degree + 1));
  }
  const Eigen::MatrixXd powers = powers_of_positions(window, degree);
  const Eigen::MatrixXd fit =
      least_squares(powers, Eigen::MatrixXd(Eigen::MatrixXd::Identity(window, window)));
  const Index m = window / 2;
  return {fit.row(0).transpose(), fit.row(1).transpose() / (static_cast<double>(m) * dt)};
}

Vector SavitzkyGolay::step_average(double dt) const {
  // x[t + j] counts every step before it: summation by parts.
  Vector average(slope.size() - 1);
  double rest = 0.0;
  for (Index k = average.size(); k-- > 0;) {
    rest += slope(k + 1);
    average(k) = dt * rest;
  }
  return average;
}

Vector slopes(const Vector& samples, Index window, double dt) {
  const Vector weights = savitzky_golay(window, 3, dt).slope;
  if (samples.size() < window) {
    throw InputError("smoothing window = " + std::to_string(window) + " samples, must be <= " +
                     std::to_string(samples.size()) + ", all that there are");
  }
  const Index m = window / 2, n = samples.size();
  Vector result(n);
  result.head(m) = slopes_of_quadratic(samples.head(window), dt).head(m);
  for (Index t = m; t < n - m; ++t) result(t) = weights.dot(samples.segment(t - m, window));
  result.tail(m) = slopes_of_quadratic(samples.tail(window), dt).tail(m);
  return result;
}

}  // namespace npdr::sim
