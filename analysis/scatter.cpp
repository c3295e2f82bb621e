#include "analysis/scatter.h"

#include <algorithm>
#include <cmath>

namespace npdr::analysis {

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
  return std::sqrt(least);
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
