#include "pipeline/import/resample.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace npdr::pipeline {
namespace {

// Part of a step that the duration may lack for one more: rounded times.
constexpr double kRounding = 1e-3;
// Straight lines say nothing new, but fill the memory.
constexpr double kMostRowsPerRow = 1000.0;

// The interval between two times that holds `time`; its first row.
Index interval_of(const std::vector<double>& times, double time) {
  const auto after = std::ranges::upper_bound(times, time);
  const Index row = after - times.begin() - 1;
  return std::clamp<Index>(row, 0, static_cast<Index>(times.size()) - 2);
}

}  // namespace

EvenRows resampled(const std::vector<double>& times, const RowMatrix& states,
                   const RowMatrix& actions, double dt) {
  const double duration = times.back() - times.front();
  const double most = kMostRowsPerRow * static_cast<double>(times.size());
  if (!(duration / dt <= most)) {
    throw InputError(fmt::format("{} s makes {:.3g} steps of {} rows, must make at most {:.0f}", dt,
                                 duration / dt, times.size(), most));
  }
  const auto num_steps = static_cast<Index>(std::floor(duration / dt + kRounding));
  if (num_steps < 1) {
    throw InputError(
        fmt::format("lasts {:.6g} s, must be at least one step of {} s", duration, dt));
  }
  EvenRows even{RowMatrix(num_steps + 1, states.cols()), RowMatrix(num_steps, actions.cols())};
  for (Index k = 0; k <= num_steps; ++k) {
    const double time = times.front() + static_cast<double>(k) * dt;
    const Index row = interval_of(times, time);
    const double begin = times[static_cast<std::size_t>(row)];
    const double length = times[static_cast<std::size_t>(row + 1)] - begin;
    const double part = std::clamp((time - begin) / length, 0.0, 1.0);
    even.states.row(k) = (1.0 - part) * states.row(row) + part * states.row(row + 1);
    if (k < num_steps) even.actions.row(k) = actions.row(interval_of(times, time + 0.5 * dt));
  }
  return even;
}

}  // namespace npdr::pipeline
