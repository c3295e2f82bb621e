#include "analysis/quantiles.h"

#include <fmt/format.h>

#include "analysis/ensembles.h"
#include "core/error.h"
#include "core/quantile.h"

namespace npdr::analysis {

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
