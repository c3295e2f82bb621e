#include "analysis/predictive_scores.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "analysis/ensembles.h"
#include "core/constants.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/quantile.h"

namespace npdr::analysis {
namespace {

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

double state_at(const std::vector<RowMatrix>& observed, const Place& at) {
  return observed[static_cast<std::size_t>(at.rollout)](at.time, at.channel);
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
  const std::vector<Index> usable = simulated.finite_samples();
  if (usable.empty()) {
    return {Vector::Constant(num_channels, kNaN),
            RowMatrix::Constant(num_levels, num_channels, kNaN), 0};
  }
  RowMatrix crps(num_times, num_channels);
  RowMatrixX<bool> within(num_times, num_levels * num_channels);
  for_each_sorted_ensemble(simulated, usable, [&](const Place& at, std::span<double> sorted) {
    const double y = state_at(observed, at);
    crps(at.row, at.channel) = crps_of_sorted(sorted, y) / amplitude(at.rollout, at.channel);
    for (Index l = 0; l < num_levels; ++l) {
      within(at.row, l * num_channels + at.channel) =
          band_of_sorted(sorted, levels[static_cast<std::size_t>(l)]).holds(y);
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
  const std::vector<Index> usable = simulated.finite_samples();
  const Index size = simulated.row_size();
  Vector y(size);
  std::vector<Band> bands(static_cast<std::size_t>(size));
  for_each_sorted_ensemble(simulated, usable, [&](const Place& at, std::span<double> sorted) {
    const Index k = at.row * simulated.num_states + at.channel;
    y(k) = state_at(observed, at);
    std::vector<double> all(sorted.begin(), sorted.end());
    all.insert(std::ranges::upper_bound(all, y(k)), y(k));
    bands[static_cast<std::size_t>(k)] = band_of_sorted(all, level);
  });
  const auto share_held = [&](const auto& states) {
    Index held = 0;
    for (Index k = 0; k < size; ++k) held += bands[static_cast<std::size_t>(k)].holds(states[k]);
    return static_cast<double>(held) / static_cast<double>(size);
  };
  ComparedCoverage found{share_held(y), Vector::Constant(simulated.num_samples, kNaN),
                         std::ssize(usable)};
  parallel_for(found.num_samples, [&](Index k) {
    const Index i = usable[static_cast<std::size_t>(k)];
    found.samples(i) = share_held(simulated.values.data() + i * size);
  });
  return found;
}

Vector log_score(const TrajectoryView& simulated, const std::vector<RowMatrix>& observed,
                 const ErrorDensity& log_density) {
  simulated.check();
  check_observed(observed, simulated);
  const std::vector<Index> usable = simulated.finite_samples();
  if (usable.empty()) return Vector::Constant(simulated.num_states, kNaN);
  RowMatrix scores(simulated.num_rollouts * simulated.num_steps, simulated.num_states);
  for_each_ensemble(simulated, usable, [&](const Place& at, std::span<double> ensemble) {
    const double y = state_at(observed, at);
    for (std::size_t k = 0; k < usable.size(); ++k) {
      ensemble[k] = log_density({usable[k], at.rollout, at.time, at.channel}, y - ensemble[k]);
    }
    scores(at.row, at.channel) = log_mean_exp(ensemble);
  });
  return scores.colwise().mean();
}

}  // namespace npdr::analysis
