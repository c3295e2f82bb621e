#include "sim/savitzky_golay.h"

#include <Eigen/QR>
#include <string>

#include "core/error.h"

namespace npdr::sim {

SavitzkyGolay savitzky_golay(Index window, Index degree, double dt) {
  if (window % 2 == 0 || window <= degree + 1) {
    throw InputError("smoothing window = " + std::to_string(window) +
                     " states, must be odd and > " + std::to_string(degree + 1));
  }
  const Index m = window / 2;
  Eigen::MatrixXd powers(window, degree + 1);  // of j / m, which keeps them well conditioned
  for (Index j = 0; j < window; ++j) {
    const double position = static_cast<double>(j - m) / static_cast<double>(m);
    double power = 1.0;
    for (Index k = 0; k <= degree; ++k, power *= position) powers(j, k) = power;
  }
  const Eigen::MatrixXd fit =
      powers.householderQr().solve(Eigen::MatrixXd::Identity(window, window));
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

}  // namespace npdr::sim
