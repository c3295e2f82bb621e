#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/text.h"
#include "pipeline/import/jumps.h"
#include "pipeline/import/rate_check.h"
#include "pipeline/import/swaps.h"

namespace npdr::pipeline {
namespace {

constexpr double kDegreesOfRadian = 180.0 / std::numbers::pi;
constexpr double kRadiansOfRpm = std::numbers::pi / 30.0;  // rad/s
constexpr double kAlike = 0.1;                             // ratios of one cause differ by less
constexpr std::size_t kMostFiles = 3;

// A ratio that one column explains.
struct KnownRatio {
  const char* unit;  // of the position
  double ratio;      // of its slope to the rate
  double tolerance;  // a part of it
  bool is_of_rate;
  const char* words;
};
// Revolutions within less than a tenth, which is more often a mistake of the clock.
constexpr std::array<KnownRatio, 5> kKnownRatios = {
    {{"rad", kDegreesOfRadian, kAlike, false, "is probably in degrees"},
     {"rad", 1.0 / kDegreesOfRadian, kAlike, true, "is probably in degrees"},
     {"rad", kRadiansOfRpm, 0.02, true, "is probably in rpm"},
     {"deg", kDegreesOfRadian, kAlike, true, "is probably in radians"},
     {"deg", 1.0 / kDegreesOfRadian, kAlike, false, "is probably in radians"}}};
constexpr KnownRatio kOpposite = {"", -1.0, kAlike, true, "probably has the wrong sign"};

struct CheckedPair {
  Channel position, rate;
  std::vector<std::optional<RateFit>> fits = {};  // one a rollout
  std::vector<std::string> leaps = {};            // of each, in words; "": none
  std::optional<double> ratio = {};               // that all of them share that say anything; not 1
  Index num_spikes = 0;                           // of the rate, where the position wraps
  std::string swap = "";                          // of columns, in words; "": none
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

std::string first_leap(const CheckedPair& pair, const Vector& position, const Vector& rate,
                       double dt) {
  const std::vector<Index> leaps = find_leaps(position, rate, dt);
  if (leaps.empty()) return "";
  const Index t = leaps.front();
  return words_of_leaps(
      pair.position.label, position, leaps, dt,
      fmt::format("{} says by {:.3g}", pair.rate.label, 0.5 * dt * (rate(t) + rate(t + 1))));
}

// A ratio that all rollouts share, within the tolerance of each but beyond what their scatter and
// their samples leave of it: that of a clock or scale a few percent off. None below 300 samples in
// all, which may be a part of a swing: rates that lag are off by the same everywhere there.
std::optional<double> slight_ratio(const std::vector<RateFit>& fits, Index num_samples) {
  // None of 6578 right rollouts of 300 samples or more is accused (encoders, differences, filters,
  // gyroscopes; 136 of devices); 5 % is found of 90 % whose rates are exact, and of none whose
  // rates a filter of 20 ms makes late.
  constexpr double practical = 0.015, scatters = 2.0;
  std::vector<double> ratios;
  double limit = 0.0;
  for (const RateFit& fit : fits) {
    if (verdict_of(fit) != RateVerdict::agrees) return std::nullopt;
    ratios.push_back(fit.ratio);
    limit = std::max(limit, practical + scatters * fit.scatter + fit.blur);
  }
  if (num_samples < 300 || ratios.empty()) return std::nullopt;
  const auto [least, most] = std::ranges::minmax(ratios);
  const double off = std::max(least - 1.0, 1.0 / most - 1.0);
  return off > limit && most - least < practical ? shared_ratio(ratios) : std::nullopt;
}

CheckedPair checked(const Target& target, const RatePair& pair) {
  CheckedPair result{.position = target.state_channels[static_cast<std::size_t>(pair.position)],
                     .rate = target.state_channels[static_cast<std::size_t>(pair.rate)]};
  std::vector<double> ratios;
  std::vector<RateFit> fits;
  Index num_samples = 0;
  bool are_all_scaled = true;
  for (const Rollout& rollout : target.rollouts) {
    const Vector position = unwrapped(target, rollout, pair.position);
    const Vector rate = rollout.states.col(pair.rate);
    result.fits.push_back(fit_rate(position, rate, target.dt));
    result.leaps.push_back(first_leap(result, position, rate, target.dt));
    result.num_spikes += count_spikes(rate, target.dt, result.position.unit);
    if (!result.fits.back()) continue;
    fits.push_back(*result.fits.back());
    num_samples += position.size();
    ratios.push_back(fits.back().ratio);
    are_all_scaled &= verdict_of(*result.fits.back()) == RateVerdict::scaled;
  }
  result.ratio = are_all_scaled ? shared_ratio(ratios) : slight_ratio(fits, num_samples);
  return result;
}

// Columns, states first, that are no part of a pair that agrees.
std::vector<Index> unexplained_columns(const Target& target, const std::vector<RatePair>& pairs,
                                       const std::vector<CheckedPair>& checked) {
  std::vector<Index> free;
  for (Index c = 0; c < target.num_states() + target.num_actions(); ++c) free.push_back(c);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!std::ranges::all_of(checked[i].fits, agrees)) continue;
    std::erase(free, pairs[i].position);
    std::erase(free, pairs[i].rate);
  }
  return free;
}

bool is_known(const CheckedPair& pair) {
  return std::ranges::any_of(pair.fits, [](const auto& fit) { return fit.has_value(); });
}

// Null: nothing known explains it.
const KnownRatio* known_ratio(double ratio, const std::string& unit) {
  if (ratio < 0.0) return &kOpposite;
  const auto known = std::ranges::find_if(kKnownRatios, [&](const KnownRatio& k) {
    return unit == k.unit && std::abs(ratio / k.ratio - 1.0) < k.tolerance;
  });
  return known == kKnownRatios.end() ? nullptr : &*known;
}

// The factor of dt that would put all rates right; none when they don't agree about one.
std::optional<double> factor_of_dt(const std::vector<CheckedPair>& pairs) {
  std::vector<double> ratios;
  for (const CheckedPair& pair : pairs) {
    if (!is_known(pair)) continue;
    if (!pair.ratio || !pair.swap.empty()) return std::nullopt;
    if (known_ratio(*pair.ratio, pair.position.unit) != nullptr) return std::nullopt;
    ratios.push_back(*pair.ratio);
  }
  return shared_ratio(ratios);
}

// "57.3", "995", "1000" where three digits would be 1e+03, and 1e+06 from there on.
std::string factor_text(double factor) {
  const bool is_whole = std::abs(factor) >= 100.0 && std::abs(factor) < 1e6;
  return is_whole ? fmt::format("{:.0f}", factor) : fmt::format("{:.3g}", factor);
}

// Differences of recorded positions are a little short of their rate: 995 is 1000, of milli-units.
std::string rounded_factor(double factor) {
  const double power = std::pow(10.0, std::round(std::log10(factor)));
  constexpr double tolerance = 0.01;  // the standard gravity of 9.81 isn't 10
  return factor_text(std::abs(factor / power - 1.0) < tolerance ? power : factor);
}

// "theta changes 57.3 times as fast as theta_dot says".
std::string mismatch(const CheckedPair& pair, double ratio) {
  return fmt::format("{} changes {} times as fast as {} says", pair.position.label,
                     factor_text(ratio), pair.rate.label);
}

std::string scale_options(const CheckedPair& pair, double ratio) {
  return fmt::format("add --scale {}={} or --scale {}={}", pair.position.label,
                     rounded_factor(1.0 / ratio), pair.rate.label, rounded_factor(ratio));
}

std::string dt_problem(const std::vector<CheckedPair>& pairs, double dt, double measured,
                       const std::string& time) {
  std::vector<std::string> mismatches;
  const CheckedPair* only = nullptr;
  for (const CheckedPair& pair : pairs) {
    if (!is_known(pair)) continue;
    mismatches.push_back(mismatch(pair, *pair.ratio));
    only = &pair;
  }
  const std::string factor = rounded_factor(measured);
  const double right = dt * std::stod(factor);
  const std::string remedy =
      time.empty() ? fmt::format("give --dt {:.3g}", right)
                   : fmt::format("correct column '{}', or add --scale {}={}", time, time, factor);
  std::string text = fmt::format("{}: dt is probably {:.6g} * {} = {:.3g} s: {}", join(mismatches),
                                 dt, factor, right, remedy);
  if (mismatches.size() > 1) return text;
  return text + "; or one of both columns is in another unit: " + scale_options(*only, measured);
}

std::string scale_problem(const CheckedPair& pair, double ratio) {
  const KnownRatio* known = known_ratio(ratio, pair.position.unit);
  if (known == nullptr) {
    return fmt::format("{}: one of both isn't what its header says; if it is in another unit, {}",
                       mismatch(pair, ratio), scale_options(pair, ratio));
  }
  const Channel& wrong = known->is_of_rate ? pair.rate : pair.position;
  return fmt::format("{}: {} [{}] {}: add --scale {}={:.6g}, or convert the column",
                     mismatch(pair, ratio), wrong.label, wrong.unit, known->words, wrong.label,
                     known->is_of_rate ? known->ratio : 1.0 / known->ratio);
}

std::string problem_of_fit(const CheckedPair& pair, const RateFit& fit,
                           const std::string& of_options) {
  if (verdict_of(fit) == RateVerdict::unrelated) {
    return fmt::format(
        "{} isn't the slope of {}: one of both columns holds another quantity; correct the header. "
        "Only where {} is right, rename the column {} and add --differentiate{}",
        pair.rate.label, pair.position.label, pair.position.label, pair.rate.label, of_options);
  }
  return mismatch(pair, fit.ratio) + ", unlike in other files: correct this one";
}

std::string spikes_problem(const CheckedPair& pair) {
  return fmt::format(
      "{} jumps in {}, as if {} moved by a turn in a step: it was computed of an angle that wraps; "
      "rename its column and add --unwrap {} --differentiate",
      pair.rate.label, counted(pair.num_spikes, "row"), pair.position.label, pair.position.label);
}

Findings problems_of(const CheckedPair& pair, const Target& target, const std::string& of_options) {
  Findings found;
  if (pair.num_spikes > 0) found.push_back(warning(spikes_problem(pair) + of_options));
  if (!pair.swap.empty() || pair.ratio) {
    found.push_back(
        warning(pair.swap.empty() ? scale_problem(pair, *pair.ratio) + of_options : pair.swap));
    return found;
  }
  std::size_t count = 0;
  for (std::size_t h = 0; h < pair.fits.size(); ++h) {
    const std::optional<RateFit>& fit = pair.fits[h];
    if (agrees(fit) && pair.leaps[h].empty()) continue;
    if (++count > kMostFiles) continue;
    found.push_back(
        warning(target.rollouts[h].name + ": " +
                (agrees(fit) ? pair.leaps[h] : problem_of_fit(pair, *fit, of_options))));
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

Finding note_of_unchecked(const Target& target, const std::vector<RatePair>& pairs) {
  std::vector<std::string> words = {"units, signs and the order of columns",
                                    "whether angles wrap or leap"};
  for (const RatePair& pair : pairs) {
    const auto label = [&](Index c) {
      return target.state_channels[static_cast<std::size_t>(c)].label;
    };
    words.push_back(
        fmt::format("whether {} is the slope of {}", label(pair.rate), label(pair.position)));
  }
  return note("not checked, for --no-rate-check: " + join(words));
}

Findings find_in_rates(const Target& target, const std::vector<RatePair>& pairs,
                       const std::string& time, const std::string& of_options) {
  std::vector<CheckedPair> all;
  for (const RatePair& pair : pairs) all.push_back(checked(target, pair));
  const std::vector<Index> free = unexplained_columns(target, pairs, all);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    CheckedPair& pair = all[i];
    if (std::ranges::all_of(pair.fits, agrees)) continue;
    pair.swap = words_of_swap(target, pairs[i], free);
  }
  if (const std::optional<double> factor = factor_of_dt(all)) {
    return {warning(dt_problem(all, target.dt, *factor, time) + of_options)};
  }
  Findings found;
  for (const CheckedPair& pair : all) append(found, problems_of(pair, target, of_options));
  if (!found.empty()) return found;
  for (const CheckedPair& pair : all) found.push_back(note(words_of_check(pair)));
  return found;
}

}  // namespace npdr::pipeline
