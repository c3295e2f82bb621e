#include "analysis/predictive_scores.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string_view>

#include "analysis/quantiles.h"
#include "core/error.h"
#include "core/parallel.h"

namespace npdr::analysis {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void check_shape(const RowMatrix& found, Index rows, Index cols, std::string_view name) {
  if (found.rows() == rows && found.cols() == cols) return;
  throw ShapeError(fmt::format("predictive scores: {} has shape ({}, {}), must be ({}, {})", name,
                               found.rows(), found.cols(), rows, cols));
}

void check_observed(const std::vector<RowMatrix>& observed, const TrajectoryView& simulated) {
  if (static_cast<Index>(observed.size()) != simulated.num_rollouts) {
    throw ShapeError(fmt::format("predictive scores: {} observed rollouts, must be {}",
                                 observed.size(), simulated.num_rollouts));
  }
  for (std::size_t h = 0; h < observed.size(); ++h) {
    check_shape(observed[h], simulated.num_steps, simulated.num_states,
                fmt::format("observed rollout {}", h));
    if (observed[h].allFinite()) continue;
    throw InputError(fmt::format(
        "predictive scores: observed rollout {} has a state that isn't finite; leave it out", h));
  }
}

// A row for each rollout and a column for each channel: what errors are divided by.
void check_amplitude(const RowMatrix& amplitude, const TrajectoryView& simulated) {
  check_shape(amplitude, simulated.num_rollouts, simulated.num_states, "amplitude");
  for (Index h = 0; h < amplitude.rows(); ++h) {
    for (Index c = 0; c < amplitude.cols(); ++c) {
      if (amplitude(h, c) > 0.0 && std::isfinite(amplitude(h, c))) continue;
      throw InputError(
          fmt::format("predictive scores: amplitude of channel {} in rollout {} = {}, must be "
                      "finite and > 0; give 1 for a channel that doesn't count",
                      c, h, amplitude(h, c)));
    }
  }
}

void check_levels(const std::vector<double>& levels) {
  for (const double level : levels) {
    if (level > 0.0 && level < 1.0) continue;
    throw InputError(
        fmt::format("predictive scores: level of a band = {}, must be in (0, 1)", level));
  }
}

std::vector<Index> usable_samples(const TrajectoryView& simulated) {
  std::vector<Index> usable;
  for (Index i = 0; i < simulated.num_samples; ++i) {
    if (simulated.finite(i)) usable.push_back(i);
  }
  return usable;
}

// One state that an ensemble predicts.
struct Place {
  Index h;
  Index t;
  Index c;
  Index time;  // h T + t, among all H T
};

// Calls score(place, ensemble) for each state, in parallel over times. The ensemble, whose order is
// that of the samples, may be changed.
void for_each_ensemble(const TrajectoryView& simulated, const std::vector<Index>& usable,
                       const std::function<void(const Place&, std::span<double>)>& score) {
  parallel_for(simulated.num_rollouts * simulated.num_steps, [&](Index time) {
    const Index h = time / simulated.num_steps;
    const Index t = time % simulated.num_steps;
    std::vector<double> ensemble(usable.size());
    for (Index c = 0; c < simulated.num_states; ++c) {
      for (std::size_t k = 0; k < usable.size(); ++k) {
        ensemble[k] = double{simulated.rollout(usable[k], h)(t, c)};
      }
      score({h, t, c, time}, ensemble);
    }
  });
}

struct Band {
  double lower;
  double upper;
  bool holds(double y) const { return y >= lower && y <= upper; }
};

Band band_of_sorted(std::span<const double> sorted, double level) {
  return {quantile_of_sorted(sorted, 0.5 * (1.0 - level)),
          quantile_of_sorted(sorted, 0.5 * (1.0 + level))};
}

// log of the mean of exponentials. The largest is taken out of the sum: all might be 0 otherwise.
double log_mean_exp(std::span<const double> logs) {
  const double largest = std::ranges::max(logs);
  if (!std::isfinite(largest)) return largest;
  double sum = 0.0;
  for (const double value : logs) sum += std::exp(value - largest);
  return largest + std::log(sum / static_cast<double>(logs.size()));
}

}  // namespace

double crps_of_sorted(std::span<const double> sorted, double y) {
  if (sorted.empty()) return kNaN;
  const auto n = static_cast<double>(sorted.size());
  // In ascending order, k = 0, ..., n - 1, half of sum_ij |x_i - x_j| is sum_k (2 k - n + 1) x_k.
  // These weights add up to 0, so x_k - y may stand for x_k, which keeps more digits.
  double error = 0.0, spread = 0.0;
  double weight = 1.0 - n;
  for (const double x : sorted) {
    error += std::abs(x - y);
    spread += weight * (x - y);
    weight += 2.0;
  }
  return error / n - spread / (n * std::max(n - 1.0, 1.0));
}

PredictiveScores predictive_scores(const TrajectoryView& simulated,
                                   const std::vector<RowMatrix>& observed,
                                   const RowMatrix& amplitude, const std::vector<double>& levels) {
  simulated.check();
  check_observed(observed, simulated);
  check_amplitude(amplitude, simulated);
  check_levels(levels);
  const Index num_times = simulated.num_rollouts * simulated.num_steps;
  const Index num_channels = simulated.num_states;
  const auto num_levels = static_cast<Index>(levels.size());
  const std::vector<Index> usable = usable_samples(simulated);
  if (usable.empty()) {
    return {Vector::Constant(num_channels, kNaN),
            RowMatrix::Constant(num_levels, num_channels, kNaN), 0};
  }
  RowMatrix crps(num_times, num_channels);
  RowMatrixX<bool> within(num_times, num_levels * num_channels);
  for_each_ensemble(simulated, usable, [&](const Place& at, std::span<double> ensemble) {
    std::ranges::sort(ensemble);
    const double y = observed[static_cast<std::size_t>(at.h)](at.t, at.c);
    crps(at.time, at.c) = crps_of_sorted(ensemble, y) / amplitude(at.h, at.c);
    for (Index l = 0; l < num_levels; ++l) {
      within(at.time, l * num_channels + at.c) =
          band_of_sorted(ensemble, levels[static_cast<std::size_t>(l)]).holds(y);
    }
  });
  const Vector num_within = within.colwise().count().transpose().cast<double>();
  return {crps.colwise().mean(),
          num_within.reshaped<Eigen::RowMajor>(num_levels, num_channels) /
              static_cast<double>(num_times),
          static_cast<Index>(usable.size())};
}

ComparedCoverage compare_coverage(const TrajectoryView& simulated,
                                  const std::vector<RowMatrix>& observed, double level) {
  simulated.check();
  check_observed(observed, simulated);
  check_levels({level});
  const std::vector<Index> usable = usable_samples(simulated);
  const Index num_channels = simulated.num_states;
  std::vector<Band> bands(
      static_cast<std::size_t>(simulated.num_rollouts * simulated.num_steps * num_channels));
  const auto value = [&](const Place& at) {
    return observed[static_cast<std::size_t>(at.h)](at.t, at.c);
  };
  for_each_ensemble(simulated, usable, [&](const Place& at, std::span<double> ensemble) {
    std::vector<double> all(ensemble.begin(), ensemble.end());
    all.push_back(value(at));
    std::ranges::sort(all);
    bands[static_cast<std::size_t>(at.time * num_channels + at.c)] = band_of_sorted(all, level);
  });
  const auto share_held = [&](const auto& state) {
    Index held = 0;
    auto band = bands.begin();
    for (Index time = 0; time < simulated.num_rollouts * simulated.num_steps; ++time) {
      const Index h = time / simulated.num_steps, t = time % simulated.num_steps;
      for (Index c = 0; c < num_channels; ++c, ++band) held += band->holds(state({h, t, c, time}));
    }
    return static_cast<double>(held) / static_cast<double>(bands.size());
  };
  ComparedCoverage found{share_held(value), Vector::Constant(simulated.num_samples, kNaN),
                         std::ssize(usable)};
  parallel_for(found.num_samples, [&](Index k) {
    const Index i = usable[static_cast<std::size_t>(k)];
    found.samples(i) =
        share_held([&](const Place& at) { return double{simulated.rollout(i, at.h)(at.t, at.c)}; });
  });
  return found;
}

Vector log_score(const TrajectoryView& simulated, const std::vector<RowMatrix>& observed,
                 const ErrorDensity& log_density) {
  simulated.check();
  check_observed(observed, simulated);
  const std::vector<Index> usable = usable_samples(simulated);
  if (usable.empty()) return Vector::Constant(simulated.num_states, kNaN);
  RowMatrix scores(simulated.num_rollouts * simulated.num_steps, simulated.num_states);
  for_each_ensemble(simulated, usable, [&](const Place& at, std::span<double> ensemble) {
    const double y = observed[static_cast<std::size_t>(at.h)](at.t, at.c);
    for (std::size_t k = 0; k < usable.size(); ++k) {
      ensemble[k] = log_density({usable[k], at.h, at.t, at.c}, y - ensemble[k]);
    }
    scores(at.time, at.c) = log_mean_exp(ensemble);
  });
  return scores.colwise().mean();
}

}  // namespace npdr::analysis
