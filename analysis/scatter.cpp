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
  double sum = 0.0;
  for (const Rollout& rollout : recording.rollouts) {
    for (Index c = 0; c < recording.num_states(); ++c) {
      const Vector series = rollout.states.col(c);
      const double largest = series.cwiseAbs().maxCoeff();
      if (largest > 0.0) sum += scatter(series) / largest;
    }
  }
  return sum / static_cast<double>(recording.num_rollouts() * recording.num_states());
}

}  // namespace npdr::analysis
