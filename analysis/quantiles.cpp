#include "analysis/quantiles.h"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/ensembles.h"
#include "core/constants.h"
#include "core/error.h"

namespace npdr::analysis {

double quantile_of_sorted(std::span<const double> sorted, double p) {
  if (sorted.empty()) return kNaN;
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
  const std::vector<Index> usable = simulated.finite_samples();
  const RowMatrix blank = RowMatrix::Zero(simulated.num_steps, simulated.num_states);
  const std::vector<RowMatrix> blanks(static_cast<std::size_t>(simulated.num_rollouts), blank);
  Bands bands{blanks, blanks, blanks, coverage, std::ssize(usable)};
  for_each_sorted_ensemble(simulated, usable, [&](const Place& at, std::span<double> sorted) {
    const auto h = static_cast<std::size_t>(at.rollout);
    bands.lower[h](at.time, at.channel) = quantile_of_sorted(sorted, 0.5 * (1.0 - coverage));
    bands.median[h](at.time, at.channel) = quantile_of_sorted(sorted, 0.5);
    bands.upper[h](at.time, at.channel) = quantile_of_sorted(sorted, 0.5 * (1.0 + coverage));
  });
  return bands;
}

}  // namespace npdr::analysis
