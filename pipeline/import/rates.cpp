#include "pipeline/import/rates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "analysis/scatter.h"
#include "core/constants.h"
#include "core/error.h"
#include "core/quantile.h"
#include "core/text.h"
#include "pipeline/store/column_labels.h"
#include "sim/savitzky_golay.h"

namespace npdr::pipeline {
namespace {

// "swing speed [rad/s]" of "swing [rad]"; "v [m/s]" of "q [m]" where both units are theirs alone.
bool may_be_rate_of(const Channel& rate, const Channel& position,
                    const std::vector<Channel>& states) {
  if (position.unit.empty() || rate.unit != rate_unit(position.unit)) return false;
  const bool are_alone = std::ranges::count(states, rate.unit, &Channel::unit) == 1 &&
                         std::ranges::count(states, position.unit, &Channel::unit) == 1;
  return are_alone || (rate.label != position.label && rate.label.starts_with(position.label));
}

bool has(const std::vector<RatePair>& pairs, Index channel, Index RatePair::*part) {
  return std::ranges::find(pairs, channel, part) != pairs.end();
}

// Of the state whose name is the longest that the rate's begins with; -1: there is none.
Index likely_position_of(const Channel& rate, const std::vector<Channel>& states) {
  Index found = -1;
  std::size_t longest = 0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!may_be_rate_of(rate, states[i], states) || states[i].label.size() <= longest) continue;
    longest = states[i].label.size();
    found = static_cast<Index>(i);
  }
  return found;
}

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

// Differences that arithmetic leaves.
double rounding_of(const Vector& position) {
  return 8.0 * std::numeric_limits<double>::epsilon() * position.cwiseAbs().maxCoeff();
}

// Third differences below it are those of printed numbers, or of a smooth motion.
double dust_of(const Vector& position) {
  constexpr double share = 1e-3;
  std::vector<double> steps;
  for (const double step : differences(position)) {
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
  const Vector third = differences(differences(differences(position))).cwiseAbs();
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

std::string rate_unit(const std::string& unit) {
  return unit + (unit.ends_with("/s") ? "^2" : "/s");
}

bool is_rate_of(const Channel& rate, const Channel& position) {
  if (rate.label != position.label + "_dot") return false;
  return rate.unit.empty() || position.unit.empty() || rate.unit == rate_unit(position.unit);
}

Vector differences(const Vector& values) {
  return values.tail(values.size() - 1) - values.head(values.size() - 1);
}

std::vector<RatePair> rate_pairs(const std::vector<Channel>& states) {
  std::vector<RatePair> pairs;
  for (std::size_t rate = 0; rate < states.size(); ++rate) {
    for (std::size_t position = 0; position < states.size(); ++position) {
      if (!is_rate_of(states[rate], states[position])) continue;
      pairs.push_back({static_cast<Index>(position), static_cast<Index>(rate)});
    }
  }
  return pairs;
}

std::vector<RatePair> likely_rate_pairs(const std::vector<Channel>& states) {
  const std::vector<RatePair> named = rate_pairs(states);
  std::vector<RatePair> pairs;
  for (Index rate = 0; rate < std::ssize(states); ++rate) {
    if (has(named, rate, &RatePair::rate)) continue;
    const Index position = likely_position_of(states[static_cast<std::size_t>(rate)], states);
    if (position < 0 || has(named, position, &RatePair::position)) continue;
    pairs.push_back({position, rate});
  }
  return pairs;
}

std::vector<Index> positions_of(const std::vector<Channel>& states) {
  static const std::set<std::string> lengths_and_angles = {"m", "cm", "mm", "rad", "deg"};
  const std::vector<RatePair> named = rate_pairs(states), likely = likely_rate_pairs(states);
  std::vector<Index> positions;
  for (Index c = 0; c < std::ssize(states); ++c) {
    const bool has_rate = has(named, c, &RatePair::position) || has(likely, c, &RatePair::position);
    const std::string& unit = states[static_cast<std::size_t>(c)].unit;
    const bool is_rate = has(named, c, &RatePair::rate) || has(likely, c, &RatePair::rate);
    if (!is_rate && (has_rate || lengths_and_angles.contains(unit))) positions.push_back(c);
  }
  return positions;
}

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
