#include "analysis/scatter.h"

#include <algorithm>
#include <cmath>

namespace npdr::analysis {
namespace {

// Of a rounded series, its tick; 0 of one that stands still.
double smallest_step(const Vector& series) {
  const double dust = 1e-9 * series.cwiseAbs().maxCoeff();
  double least = HUGE_VAL;
  for (Index t = 1; t < series.size(); ++t) {
    const double step = std::abs(series(t) - series(t - 1));
    if (step > dust) least = std::min(least, step);
  }
  return std::isfinite(least) ? least : 0.0;
}

}  // namespace

double scatter(const Vector& series) {
  constexpr Index fewest = 10, orders = 5;
  if (series.size() < fewest) return 0.0;
  Vector differences = series;
  double least = HUGE_VAL, growth = 1.0;
  for (Index p = 1; p <= orders; ++p) {
    const Index n = differences.size() - 1;
    differences = (differences.tail(n) - differences.head(n)).eval();
    growth *= 2.0 * static_cast<double>(2 * p - 1) / static_cast<double>(p);  // binom(2p, p)
    least = std::min(least, differences.squaredNorm() / static_cast<double>(n) / growth);
  }
  return std::max(std::sqrt(least), smallest_step(series) / std::sqrt(12.0));
}

double scatter_of(const Target& recording) {
  Vector of_channels = Vector::Zero(recording.num_states());
  for (const Rollout& rollout : recording.rollouts) {
    for (Index c = 0; c < recording.num_states(); ++c) {
      const Vector series = rollout.states.col(c);
      const double largest = series.cwiseAbs().maxCoeff();
      if (largest > 0.0) of_channels(c) += scatter(series) / largest;
    }
  }
  return of_channels.maxCoeff() / static_cast<double>(recording.num_rollouts());
}

}  // namespace npdr::analysis
