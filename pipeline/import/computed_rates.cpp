#include "pipeline/import/computed_rates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/scatter.h"
#include "core/constants.h"
#include "core/error.h"
#include "core/quantile.h"
#include "core/text.h"
#include "pipeline/store/column_labels.h"
#include "sim/savitzky_golay.h"

namespace npdr::pipeline {
namespace {

constexpr Index kShortest = 5;            // samples of a window
constexpr double kExplained = 7.0;        // sigma / dt
constexpr double kLeastOfLargest = 0.05;  // of the largest rate
constexpr Index kNear = 41;               // samples

void require_windows(const Target& target, Index window) {
  for (const Rollout& rollout : target.rollouts) {
    if (rollout.states.rows() >= window) continue;
    throw InputError(fmt::format("{}: has {} states, must have {} or more for --differentiate={}",
                                 rollout.name, rollout.states.rows(), window, window));
  }
}

const std::string& label_of(const Target& target, Index channel) {
  return target.state_channels[static_cast<std::size_t>(channel)].label;
}

// Simulations start from the first states, whose slopes are the least certain.
std::string words_of_first(const Target& target, Index rate, bool at_rest) {
  if (at_rest) return "0 at the first states";
  std::vector<std::string> values;
  for (const Rollout& rollout : target.rollouts) {
    values.push_back(fmt::format("{:.3g}", rollout.states(0, rate)));
  }
  return fmt::format("at the first states, where simulations start, {}; --at-rest makes them 0",
                     join(few_shortened(values)));
}

// Where slopes over a rollout's windows aren't those over a few samples.
struct Bend {
  std::size_t rollout = 0;
  Index row = 0;
  double difference = 0.0;  // in the rate's unit
};

Vector differences_of(const Vector& values) {
  return values.tail(values.size() - 1) - values.head(values.size() - 1);
}

// Differences that arithmetic leaves.
double rounding_of(const Vector& position) {
  return 8.0 * std::numeric_limits<double>::epsilon() * position.cwiseAbs().maxCoeff();
}

// Third differences below it are those of printed numbers, or of a smooth motion.
double dust_of(const Vector& position) {
  constexpr double share = 1e-3;
  std::vector<double> steps;
  for (const double step : differences_of(position)) {
    if (std::abs(step) > rounding_of(position)) steps.push_back(std::abs(step));
  }
  if (steps.empty()) return kInfinity;
  return std::max(rounding_of(position), share * upper_median(std::move(steps)));
}

// An encoder's count: the smallest third difference, since a moving one may never step by one. A
// fraction of the noise where there are no counts; 0: there are too few, as of a motion without
// noise that bends once.
double count_of(const Vector& position) {
  constexpr Index fewest = 8;  // two skipped counts have as many
  const double dust = dust_of(position);
  const Vector third = differences_of(differences_of(differences_of(position))).cwiseAbs();
  if ((third.array() > dust).count() < fewest) return 0.0;
  return (third.array() > dust).select(third.array(), kInfinity).minCoeff();
}

// sigma of positions, which may scatter more before or after t than elsewhere.
double noise_near(const Vector& position, Index t) {
  const Index count = std::min(kNear, position.size()), last = position.size() - count;
  double sigma = std::max(
      {analysis::scatter(position), count_of(position) / std::sqrt(12.0), rounding_of(position)});
  for (const Index before : {Index{0}, count / 2, count - 1}) {
    const Index first = std::clamp<Index>(t - before, 0, last);
    sigma = std::max(sigma, analysis::scatter(position.segment(first, count)));
  }
  return sigma;
}

// The largest one; none of what noise explains.
Bend largest_bend(const Target& target, const RatePair& pair, bool at_rest) {
  Bend largest;
  for (std::size_t h = 0; h < target.rollouts.size(); ++h) {
    const Vector position = target.rollouts[h].states.col(pair.position);
    const Vector rate = target.rollouts[h].states.col(pair.rate);
    Vector differences = (sim::slopes(position, kShortest, target.dt) - rate).cwiseAbs();
    if (at_rest) differences(0) = 0.0;  // that rate isn't a slope
    Index t = 0;
    const double most = differences.maxCoeff(&t);
    const bool is_large = most > kLeastOfLargest * rate.cwiseAbs().maxCoeff() &&
                          most > kExplained * noise_near(position, t) / target.dt;
    if (is_large && most > largest.difference) largest = {h, t, most};
  }
  return largest;
}

// Few checks of a posterior pass where rates are wrong by more than noise.
Finding warning_of(const Target& target, const RatePair& pair, const Bend& bend, Index window) {
  const auto& [rate, unit] = target.state_channels[static_cast<std::size_t>(pair.rate)];
  const std::string& position = label_of(target, pair.position);
  return warning(fmt::format(
      "{}: {} may be off by {:.3g} [{}] in row {}: a sample near it is wrong, missing or repeated, "
      "or {} bends too much for {} samples; correct it, leave these rows out, or give a shorter "
      "window, which is noisier, --differentiate={}{}",
      target.rollouts[bend.rollout].name, rate, bend.difference, unit, bend.row + 1, position,
      window, std::max(kShortest, (window + 1) / 4 * 2 + 1),
      bend.row == 0 ? ", or --at-rest if it stood still" : ""));
}

}  // namespace

Findings compute_rates(Target& target, const std::vector<RatePair>& pairs,
                       const RateOptions& options) {
  const Index window = options.window;
  require_windows(target, window);
  Findings found;
  for (const RatePair& pair : pairs) {
    for (Rollout& rollout : target.rollouts) {
      rollout.states.col(pair.rate) =
          sim::slopes(rollout.states.col(pair.position), window, target.dt);
      if (options.at_rest) rollout.states(0, pair.rate) = 0.0;
    }
    found.push_back(
        note(fmt::format("computed {}: slope of {} over {} samples, {:.4g} s (Savitzky-Golay); {}",
                         label_of(target, pair.rate), label_of(target, pair.position), window,
                         static_cast<double>(window - 1) * target.dt,
                         words_of_first(target, pair.rate, options.at_rest))));
    if (options.is_resampled) continue;
    const Bend bend = largest_bend(target, pair, options.at_rest);
    if (bend.difference > 0.0) found.push_back(warning_of(target, pair, bend, window));
  }
  return found;
}

}  // namespace npdr::pipeline
