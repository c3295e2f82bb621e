#include "pipeline/import/rate_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/text.h"
#include "pipeline/import/angle_wraps.h"

namespace npdr::pipeline {
namespace {

constexpr double kDegreesOfRadian = 180.0 / std::numbers::pi;
constexpr double kRadiansOfRpm = std::numbers::pi / 30.0;  // rad/s
constexpr double kAlike = 0.1;                             // ratios of one cause differ by less
constexpr std::size_t kMostFiles = 3;

struct CheckedPair {
  Channel position, rate;
  std::vector<std::optional<RateFit>> fits = {};  // one a rollout
  std::vector<std::string> leaps = {};            // of each, in words; "": none
  std::optional<double> ratio = {};               // that all of them share that say anything; not 1
  Index num_spikes = 0;                           // of the rate, where the position wraps
  std::string slope = "";   // label of another rate that is the slope; empty: none
  bool is_swapped = false;  // the position is the slope of the rate
};

bool are_near(double a, double b) { return std::abs(a - b) < kAlike * std::abs(b); }

std::optional<double> shared_ratio(const std::vector<double>& ratios) {
  if (ratios.empty()) return std::nullopt;
  std::vector<double> sorted = ratios;
  std::ranges::sort(sorted);
  const double middle = 0.5 * (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]);
  const bool is_shared =
      std::ranges::all_of(ratios, [&](double ratio) { return are_near(ratio, middle); });
  return is_shared ? std::optional(middle) : std::nullopt;
}

// Without jumps by whole turns, which are told elsewhere.
Vector unwrapped_position(const Target& target, const RatePair& pair, const Rollout& rollout) {
  Vector position = rollout.states.col(pair.position);
  const std::string& unit = target.state_channels[static_cast<std::size_t>(pair.position)].unit;
  const AngleJumps jumps = find_jumps(position, unit);
  if (!jumps.rows.empty()) unwrap(position, jumps.period);
  return position;
}

std::optional<RateFit> fit_of(const Target& target, const RatePair& pair, const Rollout& rollout) {
  return fit_rate(unwrapped_position(target, pair, rollout), rollout.states.col(pair.rate),
                  target.dt);
}

// `position`: without jumps by whole turns.
std::string words_of_leaps(const Target& target, const RatePair& pair, const Rollout& rollout,
                           const Vector& position) {
  const Vector rate = rollout.states.col(pair.rate);
  const std::vector<Index> leaps = find_leaps(position, rate, target.dt);
  if (leaps.empty()) return "";
  const auto label = [&](Index c) {
    return target.state_channels[static_cast<std::size_t>(c)].label;
  };
  const Index t = leaps.front();
  return fmt::format(
      "{} moves by {:.3g} in the step after {:.6g} s{}, {} says by {:.3g}: it wraps there, or "
      "samples are missing, stood still or stand for none; correct these rows, or cut the rollout "
      "there",
      label(pair.position), position(t + 1) - position(t), static_cast<double>(t) * target.dt,
      leaps.size() > 1 ? fmt::format(" (and {} times more)", leaps.size() - 1) : "",
      label(pair.rate), 0.5 * target.dt * (rate(t) + rate(t + 1)));
}

CheckedPair checked(const Target& target, const RatePair& pair) {
  CheckedPair result{.position = target.state_channels[static_cast<std::size_t>(pair.position)],
                     .rate = target.state_channels[static_cast<std::size_t>(pair.rate)]};
  std::vector<double> ratios;
  bool are_all_scaled = true;
  for (const Rollout& rollout : target.rollouts) {
    const Vector position = unwrapped_position(target, pair, rollout);
    result.fits.push_back(fit_rate(position, rollout.states.col(pair.rate), target.dt));
    result.leaps.push_back(words_of_leaps(target, pair, rollout, position));
    result.num_spikes +=
        count_spikes(rollout.states.col(pair.rate), target.dt, result.position.unit);
    if (!result.fits.back()) continue;
    ratios.push_back(result.fits.back()->ratio);
    are_all_scaled &= verdict_of(*result.fits.back()) == RateVerdict::scaled;
  }
  if (are_all_scaled) result.ratio = shared_ratio(ratios);
  return result;
}

bool agrees(const std::optional<RateFit>& fit) {
  return !fit || verdict_of(*fit) == RateVerdict::agrees;
}

bool is_slope_everywhere(const Target& target, const RatePair& pair) {
  return std::ranges::all_of(target.rollouts, [&](const Rollout& rollout) {
    const auto fit = fit_of(target, pair, rollout);
    return fit && agrees(fit);
  });
}

// Another pair's rate that agrees with this position in every rollout, where its own doesn't.
std::string other_slope(const Target& target, const std::vector<RatePair>& pairs,
                        const CheckedPair& checked, Index position) {
  if (std::ranges::all_of(checked.fits, agrees)) return "";
  for (const RatePair& other : pairs) {
    if (other.position == position) continue;
    if (!is_slope_everywhere(target, {position, other.rate})) continue;
    return target.state_channels[static_cast<std::size_t>(other.rate)].label;
  }
  return "";
}

bool is_known(const CheckedPair& pair) {
  return std::ranges::any_of(pair.fits, [](const auto& fit) { return fit.has_value(); });
}

bool is_of_degrees(double ratio, const std::string& unit) {
  return turn_in(unit) &&
         (are_near(ratio, kDegreesOfRadian) || are_near(ratio, 1.0 / kDegreesOfRadian));
}

// Nearer than a tenth, which is more often a mistake of the clock.
bool is_of_rpm(double ratio, const std::string& unit) {
  return unit == "rad" && std::abs(ratio / kRadiansOfRpm - 1.0) < 0.02;
}

bool is_of_unit(double ratio, const std::string& unit) {
  return is_of_degrees(ratio, unit) || is_of_rpm(ratio, unit);
}

// The factor of dt that would put all rates right; none when they don't agree about one.
std::optional<double> factor_of_dt(const std::vector<CheckedPair>& pairs) {
  std::vector<double> ratios;
  for (const CheckedPair& pair : pairs) {
    if (!is_known(pair)) continue;
    if (!pair.ratio || *pair.ratio < 0.0 || !pair.slope.empty() || pair.is_swapped ||
        is_of_unit(*pair.ratio, pair.position.unit)) {
      return std::nullopt;
    }
    ratios.push_back(*pair.ratio);
  }
  return shared_ratio(ratios);
}

// Differences of recorded positions are a little short of their rate: 995 is 1000, of milli-units.
double rounded_factor(double factor) {
  const double power = std::pow(10.0, std::round(std::log10(std::abs(factor))));
  constexpr double tolerance = 0.01;  // the standard gravity of 9.81 isn't 10
  const bool is_power = power != 1.0 && std::abs(std::abs(factor) / power - 1.0) < tolerance;
  return is_power ? std::copysign(power, factor) : factor;
}

// "57.3", "995", "1000" where three digits would be 1e+03, and 1e+06 from there on.
std::string factor_text(double factor) {
  const bool is_whole = std::abs(factor) >= 100.0 && std::abs(factor) < 1e6;
  return is_whole ? fmt::format("{:.0f}", factor) : fmt::format("{:.3g}", factor);
}

std::string known_scale_option(const Channel& channel, double factor) {
  return fmt::format("--scale {}={:.6g}", channel.label, factor);
}

std::string scale_option(const Channel& channel, double measured) {
  return fmt::format("--scale {}={}", channel.label, factor_text(rounded_factor(measured)));
}

// "theta changes 57.3 times as fast as theta_dot says".
std::string mismatch(const CheckedPair& pair, double ratio) {
  return fmt::format("{} changes {} times as fast as {} says", pair.position.label,
                     factor_text(ratio), pair.rate.label);
}

std::string remedy_of_dt(double dt, double measured, const std::string& time) {
  const double factor = rounded_factor(measured);
  const std::string found =
      fmt::format("dt is probably {:.6g} * {} = {:.3g} s", dt, factor_text(factor), dt * factor);
  if (time.empty()) return fmt::format("{}: give --dt {:.3g}", found, dt * factor);
  return fmt::format("{}: correct column '{}', or add --scale {}={}", found, time, time,
                     factor_text(factor));
}

std::string dt_problem(const std::vector<CheckedPair>& pairs, double dt, double factor,
                       const std::string& time) {
  std::vector<std::string> mismatches;
  const CheckedPair* only = nullptr;
  for (const CheckedPair& pair : pairs) {
    if (!is_known(pair)) continue;
    mismatches.push_back(mismatch(pair, *pair.ratio));
    only = &pair;
  }
  std::string text = join(mismatches) + ": " + remedy_of_dt(dt, factor, time);
  if (mismatches.size() > 1) return text;
  return text + "; or one of both columns is in another unit: add " +
         scale_option(only->position, 1.0 / factor) + " or " + scale_option(only->rate, factor);
}

// One column in degrees, the other in radians: the one that contradicts its unit.
std::string degrees_problem(const CheckedPair& pair, double ratio) {
  const bool is_position = (ratio > 1.0) == (pair.position.unit == "rad");
  const Channel& wrong = is_position ? pair.position : pair.rate;
  const bool is_degrees = pair.position.unit == "rad";
  return fmt::format(
      "{}: {} is probably in {}, though its unit says [{}]: add {}, or convert the column",
      mismatch(pair, ratio), wrong.label, is_degrees ? "degrees" : "radians", wrong.unit,
      known_scale_option(wrong, is_degrees ? 1.0 / kDegreesOfRadian : kDegreesOfRadian));
}

std::string rpm_problem(const CheckedPair& pair, double ratio) {
  return fmt::format(
      "{}: {} is probably in rpm, though its unit says [{}]: add {}, or convert the column",
      mismatch(pair, ratio), pair.rate.label, pair.rate.unit,
      known_scale_option(pair.rate, kRadiansOfRpm));
}

std::string scale_problem(const CheckedPair& pair, double ratio) {
  if (is_of_degrees(ratio, pair.position.unit)) return degrees_problem(pair, ratio);
  if (is_of_rpm(ratio, pair.position.unit)) return rpm_problem(pair, ratio);
  if (are_near(ratio, -1.0)) {
    return fmt::format("{} falls where {} says that it rises: one of both has the wrong sign: {}",
                       pair.position.label, pair.rate.label, "add " + scale_option(pair.rate, -1));
  }
  if (ratio < 0.0) {
    return fmt::format(
        "{}, which no unit explains: are the two columns swapped, or is one another quantity's? "
        "Correct the header",
        mismatch(pair, ratio));
  }
  return fmt::format(
      "{}: one of both isn't what its header says; if it is in another unit, add {} or {}",
      mismatch(pair, ratio), scale_option(pair.position, 1.0 / ratio),
      scale_option(pair.rate, ratio));
}

std::string problem_of_fit(const CheckedPair& pair, const RateFit& fit) {
  if (verdict_of(fit) == RateVerdict::unrelated) {
    return fmt::format(
        "{} isn't the slope of {}: it has no fixed ratio to it; is it another quantity's? Rename "
        "its column and add --differentiate",
        pair.rate.label, pair.position.label);
  }
  return mismatch(pair, fit.ratio) + ", unlike in other files: correct this one";
}

std::string spikes_problem(const CheckedPair& pair) {
  return fmt::format(
      "{} jumps in {}, as if {} moved by a turn in a step: it was computed of an angle that wraps; "
      "rename its column and add --unwrap {} --differentiate",
      pair.rate.label, counted(pair.num_spikes, "row"), pair.position.label, pair.position.label);
}

Findings problems_of(const CheckedPair& pair, const std::vector<std::string>& files) {
  Findings found;
  const auto tell = [&](std::string text) { found.push_back(warning(std::move(text))); };
  if (pair.num_spikes > 0) tell(spikes_problem(pair));
  if (pair.is_swapped) {
    tell(fmt::format("{} is the slope of {}: the two columns are swapped; correct the header",
                     pair.position.label, pair.rate.label));
    return found;
  }
  if (!pair.slope.empty()) {
    tell(fmt::format("{} isn't the slope of {}, but {} is: are columns swapped? Correct the header",
                     pair.rate.label, pair.position.label, pair.slope));
    return found;
  }
  if (pair.ratio) {
    tell(scale_problem(pair, *pair.ratio));
    return found;
  }
  std::size_t count = 0;
  for (std::size_t h = 0; h < files.size(); ++h) {
    const bool is_slope = agrees(pair.fits[h]);
    if (is_slope && pair.leaps[h].empty()) continue;
    if (++count > kMostFiles) continue;
    tell(files[h] + ": " + (is_slope ? pair.leaps[h] : problem_of_fit(pair, *pair.fits[h])));
  }
  if (count > kMostFiles) {
    found.back().what += fmt::format(" ({} more files are like it)", count - kMostFiles);
  }
  return found;
}

std::string words_of_check(const CheckedPair& pair) {
  if (!is_known(pair)) {
    return fmt::format(
        "not checked: whether {} is the slope of {}, which moves too little, or is shorter than {} "
        "rows",
        pair.rate.label, pair.position.label, kFewestSamples);
  }
  double deviation = 0.0;
  Index num_unknown = 0;
  for (const auto& fit : pair.fits) {
    num_unknown += !fit;
    if (fit) deviation = std::max(deviation, std::abs(fit->ratio - 1.0));
  }
  std::string words = fmt::format("checked: {} is the slope of {}, to {:.2g} %", pair.rate.label,
                                  pair.position.label, 100.0 * deviation);
  if (num_unknown > 0) {
    words += fmt::format(
        "; not in {} of {} rollouts, where it moves too little or that are shorter than {} rows",
        num_unknown, pair.fits.size(), kFewestSamples);
  }
  return words;
}

}  // namespace

Findings find_in_rates(const Target& target, const std::vector<RatePair>& pairs,
                       const std::vector<std::string>& files, const std::string& time) {
  std::vector<CheckedPair> all;
  for (const RatePair& pair : pairs) {
    all.push_back(checked(target, pair));
    all.back().slope = other_slope(target, pairs, all.back(), pair.position);
    all.back().is_swapped = !std::ranges::all_of(all.back().fits, agrees) &&
                            is_slope_everywhere(target, {pair.rate, pair.position});
  }
  if (const std::optional<double> factor = factor_of_dt(all)) {
    return {warning(dt_problem(all, target.dt, *factor, time))};
  }
  Findings found;
  for (const CheckedPair& pair : all) append(found, problems_of(pair, files));
  for (const CheckedPair& pair : all) found.push_back(note(words_of_check(pair)));
  return found;
}

}  // namespace npdr::pipeline
