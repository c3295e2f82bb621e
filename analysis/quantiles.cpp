#include "analysis/quantiles.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/error.h"
#include "core/parallel.h"

namespace npdr::analysis {

double quantile_of_sorted(std::span<const double> sorted, double p) {
  if (sorted.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double position = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double weight = position - static_cast<double>(below);
  return sorted[below] + weight * (sorted[above] - sorted[below]);
}

Bands quantile_bands(const TrajectoryView& simulated, double coverage) {
  simulated.check();
  if (!(coverage > 0.0 && coverage < 1.0)) {
    throw InputError(fmt::format("band coverage = {}, must be in (0, 1)", coverage));
  }
  std::vector<Index> usable;
  for (Index i = 0; i < simulated.num_samples; ++i) {
    if (simulated.finite(i)) usable.push_back(i);
  }
  const RowMatrix blank = RowMatrix::Zero(simulated.num_steps, simulated.num_states);
  const std::vector<RowMatrix> blanks(static_cast<std::size_t>(simulated.num_rollouts), blank);
  Bands bands{blanks, blanks, blanks, coverage, static_cast<Index>(usable.size())};
  parallel_for(simulated.num_rollouts * simulated.num_steps, [&](Index item) {
    const Index h = item / simulated.num_steps;
    const Index t = item % simulated.num_steps;
    const auto rollout = static_cast<std::size_t>(h);
    std::vector<double> values(usable.size());
    for (Index c = 0; c < simulated.num_states; ++c) {
      for (std::size_t k = 0; k < usable.size(); ++k) {
        values[k] = double{simulated.rollout(usable[k], h)(t, c)};
      }
      std::sort(values.begin(), values.end());
      bands.lower[rollout](t, c) = quantile_of_sorted(values, 0.5 * (1.0 - coverage));
      bands.median[rollout](t, c) = quantile_of_sorted(values, 0.5);
      bands.upper[rollout](t, c) = quantile_of_sorted(values, 0.5 * (1.0 + coverage));
    }
  });
  return bands;
}

}  // namespace npdr::analysis
