#include "pipeline/import/csv_import.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/import/jumps.h"
#include "pipeline/import/rate_check.h"
#include "pipeline/import/recording_warnings.h"
#include "pipeline/store/column_labels.h"
#include "pipeline/store/number_table.h"

namespace npdr::pipeline {
namespace {

void check_options(const CsvOptions& options) {
  for (const auto& [name, value] :
       {std::pair("--dt", options.dt), std::pair("--resample", options.resample)}) {
    if (!value || (*value > 0.0 && std::isfinite(*value))) continue;
    throw InputError(fmt::format("{} = {}, must be a time > 0 [s]", name, *value));
  }
  if (options.dt && options.resample) {
    throw InputError("--resample says how far states are apart; leave out --dt, or it");
  }
  if (options.channels.states.empty()) throw InputError("no states to import: name their columns");
  const std::optional<Index>& window = options.differentiate;
  if (options.at_rest && !window) {
    throw InputError("--at-rest is about rates that --differentiate computes; add that");
  }
  if (window && (*window < 5 || *window % 2 == 0)) {
    throw InputError(
        fmt::format("--differentiate={}, must be an odd number of samples, 5 or more", *window));
  }
}

// Every file must be a recording of the same system.
void require_alike(const CsvRows& rows, const CsvRows& first) {
  check_channels(rows.name + ": states", rows.states, first.states);
  check_channels(rows.name + ": actions", rows.actions, first.actions);
  if (rows.lacking == first.lacking) return;
  throw InputError(fmt::format(
      "{}: must have columns for the same rates as {}: computed ones differ from measured ones",
      rows.name, first.name));
}

std::vector<CsvRows> read_files(const std::vector<std::filesystem::path>& paths,
                                const CsvOptions& options) {
  std::vector<CsvRows> files;
  for (const std::filesystem::path& path : paths) {
    files.push_back(read_csv_rows(path, options));
    require_alike(files.back(), files.front());
  }
  if (options.differentiate && files.front().lacking.empty()) {
    throw InputError(files.front().name +
                     ": --differentiate has nothing to compute: it computes each state X_dot, "
                     "named after another one, X, that the file has no column of");
  }
  return files;
}

// The files' rows as they are, of which `files` keep the rest: rollouts have the names of files.
Target take_rollouts(std::vector<CsvRows>& files) {
  Target target;
  target.state_channels = files.front().states;
  target.action_channels = files.front().actions;
  for (CsvRows& rows : files) target.rollouts.push_back(std::move(rows.rollout));
  return target;
}

// Puts rollouts on one dt; their lengths may differ.
void make_even(Target& target, const std::vector<CsvRows>& files, const CsvOptions& options) {
  target.dt = options.resample ? *options.resample : even_step(files, options.dt);
  if (!options.resample) return;
  for (std::size_t h = 0; h < files.size(); ++h) {
    target.rollouts[h] = resampled(files[h], target.rollouts[h], target.dt);
  }
}

// Names of the files; where two are the same, with the folder before it.
void name_rollouts(const std::vector<std::filesystem::path>& paths, Target& target) {
  std::map<std::string, int> count;
  for (const auto& path : paths) ++count[path.stem().string()];
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const auto stem = paths[i].stem();
    const bool is_unique = count[stem.string()] == 1;
    target.rollouts[i].name =
        (is_unique ? stem : paths[i].parent_path().filename() / stem).string();
  }
}

// Also of a grid that is much finer than the samples, of which rates are taken over a part of one.
Findings find_in_resampling(const std::vector<CsvRows>& files, double dt) {
  constexpr double least = 0.5;
  double usual = 0.0;  // of the slowest file
  TimeSteps all = steps_of(files.front().times);
  for (const CsvRows& rows : files) {
    const TimeSteps steps = steps_of(rows.times);
    all.shortest = std::min(all.shortest, steps.shortest);
    all.longest = std::max(all.longest, steps.longest);
    usual = std::max(usual, steps.median);
  }
  Findings found = {note(fmt::format(
      "resampled to {} s: steps were {:.4g} to {:.4g} s; lines between them count as measured", dt,
      all.shortest, all.longest))};
  if (dt < least * usual) {
    found.push_back(warning(
        fmt::format("--resample {} is finer than the samples, {:.4g} s apart: give {:.3g} or more",
                    dt, usual, usual)));
  }
  return found;
}

// A rollout that counts twice makes posteriors narrower than they are.
void require_no_copies(const Target& target) {
  for (const auto& [one, other] : copies_of(target)) {
    throw InputError(fmt::format("{}: holds the same numbers as {}; name each rollout once",
                                 target.rollouts[other].name, target.rollouts[one].name));
  }
}

// Of some, those that were measured; computed ones are right.
std::vector<RatePair> measured(std::vector<RatePair> pairs, const CsvRows& rows) {
  std::erase_if(pairs, [&](const RatePair& pair) {
    return std::ranges::find(rows.lacking, pair) != rows.lacking.end();
  });
  return pairs;
}

std::string source_of(const std::vector<std::filesystem::path>& paths) {
  std::vector<std::string> names;
  for (const std::filesystem::path& path : paths) names.push_back(path.filename().string());
  return join(names);
}

// Of the files as such: what nobody asked for may be what the simulator is given.
Findings find_in_files(const std::vector<CsvRows>& files) {
  Findings found;
  if (const auto& ignored = files.front().ignored; !ignored.empty()) {
    found.push_back(note(fmt::format("not imported: {}; --states and --actions name what is",
                                     join(few_shortened(ignored)))));
  }
  for (const CsvRows& rows : files) {
    if (!rows.has_line_end) found.push_back(warning_of_end(rows.name));
  }
  return found;
}

// Rates are the slopes of angles also where all of a motion is in degrees; few begin beyond a turn.
Findings find_far_beginning(const Target& target) {
  for (const Rollout& rollout : target.rollouts) {
    for (Index c = 0; c < target.num_states(); ++c) {
      const auto& [label, unit] = target.state_channels[static_cast<std::size_t>(c)];
      const double first = rollout.states(0, c);
      if (unit != "rad" || std::abs(first) <= 2.0 * std::numbers::pi) continue;
      return {warning(fmt::format(
          "{}: {} begins at {:.3g} rad, more than a turn from zero: if it is in degrees, add "
          "--scale {}=0.0174533, and the same for its rate",
          rollout.name, label, first, label))};
    }
  }
  return {};
}

// Motions are recorded faster than that; measured rates would contradict another clock.
Findings find_slow_clock(const Target& target) {
  constexpr double slow = 1.0;  // [s]
  if (target.dt < slow || rate_pairs(target.state_channels).empty()) return {};
  return {warning(
      fmt::format("steps of {:.6g} s are long for a motion: if times are in ms, --scale the column "
                  "of times by 0.001, or give --dt or --resample in s",
                  target.dt))};
}

bool is_problem(const Finding& finding) { return finding.severity != Severity::note; }

// All at once, after glitches, which may be the cause.
[[noreturn]] void refuse(Findings glitches, Findings found) {
  append(glitches, std::move(found));
  std::string problems;
  for (const Finding& finding : glitches) {
    if (is_problem(finding)) problems += finding.what + "\n";
  }
  throw InputError(problems +
                   "--no-rate-check imports the files as they are; every run then warns of angles "
                   "and rates that contradict each other");
}

// What was checked of rates, and what is probably wrong.
Findings check_rates(const Target& target, const CsvRows& first, Findings turns,
                     const Findings& glitches) {
  const std::vector<RatePair> pairs = measured(rate_pairs(first.states), first);
  Findings found = std::move(turns);
  append(found, find_in_rates(target, pairs, first.time));
  if (std::ranges::any_of(found, is_problem)) refuse(glitches, std::move(found));
  const std::vector<RatePair> likely = measured(likely_rate_pairs(first.states), first);
  for (Finding& finding : find_in_rates(target, likely, first.time)) {
    if (is_problem(finding)) {
      finding.what += "; nothing is wrong where these aren't a position and its rate";
    }
    found.push_back(std::move(finding));
  }
  append(found, find_leaps(target));
  append(found, find_slow_clock(target));
  append(found, find_far_beginning(target));
  if (pairs.empty() && likely.empty()) {
    found.push_back(
        note("not checked: units, signs and the order of columns, since none of them is the "
             "measured rate of another"));
  }
  return found;
}

Index shortest_of(const Target& target) {
  return std::ranges::min(target.rollouts, {}, &Rollout::num_steps).num_steps();
}

void require_equal_lengths(const Target& target) {
  for (const Rollout& rollout : target.rollouts) {
    if (rollout.num_steps() == target.num_steps()) continue;
    throw InputError(fmt::format(
        "rollout {} has {} of {:.6g} s, the first one has {}; to cut them to one length, add "
        "--length shortest or --length STEPS",
        rollout.name, counted(rollout.num_steps(), "step"), target.dt, target.num_steps()));
  }
}

Rollout piece(const Rollout& rollout, Index number, Index num_steps) {
  const Index begin = number * num_steps;
  return {fmt::format("{}.{}", rollout.name, number + 1),
          rollout.states.middleRows(begin, num_steps + 1),
          rollout.actions.middleRows(begin, num_steps)};
}

}  // namespace

Findings cut_rollouts(Target& target, const std::optional<Index>& length) {
  if (!length) {
    require_equal_lengths(target);
    return {};
  }
  const Index num_steps = *length == 0 ? shortest_of(target) : *length;
  std::vector<std::string> origins;
  std::vector<Rollout> pieces;
  for (const Rollout& rollout : target.rollouts) {
    const Index count = rollout.num_steps() / num_steps;
    if (count == 0) {
      throw InputError(fmt::format("--length {}: rollout {} has {}, must have at least as many",
                                   num_steps, rollout.name, counted(rollout.num_steps(), "step")));
    }
    for (Index k = 0; k < count; ++k) pieces.push_back(piece(rollout, k, num_steps));
    if (count == 1) pieces.back().name = rollout.name;
    origins.push_back(fmt::format("{} of {} ({} dropped)", count, rollout.name,
                                  counted(rollout.num_steps() - count * num_steps, "step")));
  }
  target.rollouts = std::move(pieces);
  return {
      note(fmt::format("cut into rollouts of {}: {}", counted(num_steps, "step"), join(origins)))};
}

ImportedRecording import_csv(const std::vector<std::filesystem::path>& paths,
                             const CsvOptions& options) {
  if (paths.empty()) throw InputError("no CSV files to import");
  check_options(options);
  std::vector<CsvRows> files = read_files(paths, options);
  ImportedRecording result{take_rollouts(files), find_in_files(files)};
  auto& [target, found] = result;
  require_no_copies(target);
  const Findings glitches = find_glitches(target);
  append(found, glitches);
  append(found, unwrap_turns(target, options.unwrap));
  Findings turns = find_turns(target);
  make_even(target, files, options);
  if (options.resample) append(found, find_in_resampling(files, *options.resample));
  const CsvRows& first = files.front();
  if (options.differentiate) {
    append(found,
           compute_rates(target, first.lacking,
                         {*options.differentiate, options.at_rest, options.resample.has_value()}));
  }
  if (options.check_rates) {
    append(found, check_rates(target, first, std::move(turns), glitches));
  } else {
    found.push_back(note_of_unchecked(target, measured(rate_pairs(first.states), first)));
  }
  name_rollouts(paths, target);
  append(found, cut_rollouts(target, options.length));
  target.source = options.source.empty() ? source_of(paths) : options.source;
  target.check(paths.front().string());
  return result;
}

}  // namespace npdr::pipeline
