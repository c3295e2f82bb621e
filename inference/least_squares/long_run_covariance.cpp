#include "inference/least_squares/long_run_covariance.h"

#include <algorithm>
#include <cmath>

namespace npdr::inference {

Index num_lags(const RowMatrix& g, Index num_series) {
  const Index steps = g.rows() / num_series;
  const double most = 1.0 - 1.0 / static_cast<double>(steps + 1);  // of a correlation
  double top = 0.0, bottom = 0.0;
  for (Index d = 0; d < g.cols(); ++d) {
    double covariance = 0.0, variance = 0.0;
    for (Index h = 0; h < num_series; ++h) {
      const auto series = g.col(d).segment(h * steps, steps);
      covariance += series.head(steps - 1).dot(series.tail(steps - 1));
      variance += series.squaredNorm();
    }
    if (!(variance > 0.0)) continue;
    const double rho = std::clamp(covariance / variance, -most, most);
    // Each column over its own variance, of which (1 - rho^2) is new in each step.
    const double fresh = std::pow(1.0 - rho * rho, 2);
    top += 4.0 * rho * rho * fresh / (std::pow(1.0 - rho, 6) * std::pow(1.0 + rho, 2));
    bottom += fresh / std::pow(1.0 - rho, 4);
  }
  if (!(bottom > 0.0)) return 1;
  const double lags = 1.1447 * std::cbrt(top / bottom * static_cast<double>(g.rows()));
  return std::clamp<Index>(static_cast<Index>(std::ceil(lags)), 1, steps);
}

// Triangular weights are those of sums over all windows of L steps, divided by L.
RowMatrix long_run_covariance(const RowMatrix& g, Index num_series, Index num_lags) {
  const Index steps = g.rows() / num_series;
  RowMatrix sum = RowMatrix::Zero(g.cols(), g.cols());
  for (Index h = 0; h < num_series; ++h) {
    Vector window = Vector::Zero(g.cols());
    for (Index t = 0; t < steps + num_lags - 1; ++t) {
      if (t < steps) window += g.row(h * steps + t).transpose();
      if (t >= num_lags) window -= g.row(h * steps + t - num_lags).transpose();
      sum.selfadjointView<Eigen::Lower>().rankUpdate(window);
    }
  }
  const RowMatrix full = sum.selfadjointView<Eigen::Lower>();
  const double b = static_cast<double>(num_lags) / static_cast<double>(g.rows());
  const double c = 1.0 + b * (1.3289 + b * (0.1910 - 0.2083 * b));
  return c * c / static_cast<double>(num_lags) * full;
}

}  // namespace npdr::inference
