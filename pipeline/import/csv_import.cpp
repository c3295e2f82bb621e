#include "pipeline/import/csv_import.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/import/computed_rates.h"
#include "pipeline/import/csv_rows.h"
#include "pipeline/import/csv_times.h"
#include "pipeline/import/csv_turns.h"
#include "pipeline/import/glitch_report.h"
#include "pipeline/import/rate_report.h"
#include "pipeline/import/recording_warnings.h"
#include "pipeline/import/resample.h"
#include "pipeline/import/rollout_length.h"
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

std::string nothing_to_compute(const CsvRows& rows) {
  if (!rate_pairs(rows.states).empty()) {
    return ": has a column for every rate, so --differentiate has nothing to compute; leave it "
           "out, or rename the columns of rates to replace";
  }
  const Channel& first = rows.states.front();
  return fmt::format(
      ": --differentiate has nothing to compute, since no state is called X_dot after another one, "
      "X: name those to compute, too, such as '{}_dot [{}]' of '{}'",
      first.label, rate_unit(first.unit), first.label);
}

std::vector<CsvRows> read_files(const std::vector<std::filesystem::path>& paths,
                                const CsvOptions& options) {
  std::vector<CsvRows> files;
  for (const std::filesystem::path& path : paths) {
    files.push_back(read_csv_rows(path, options));
    require_alike(files.back(), files.front());
  }
  if (options.differentiate && files.front().lacking.empty()) {
    throw InputError(files.front().name + nothing_to_compute(files.front()));
  }
  return files;
}

Rollout resampled_rollout(const CsvRows& rows, double dt) {
  check_times_to_resample(rows, dt);
  try {
    EvenRows even = resampled(rows.times, rows.state_values, rows.action_values, dt);
    return {"", std::move(even.states), std::move(even.actions)};
  } catch (const InputError& error) {
    throw InputError(rows.name + ": --resample: " + error.what());
  }
}

// Rollouts of one dt; their lengths may differ.
Target even_target(const std::vector<CsvRows>& files, const CsvOptions& options) {
  Target target;
  target.state_channels = files.front().states;
  target.action_channels = files.front().actions;
  target.dt = options.resample ? *options.resample : even_step(files.front(), options.dt);
  for (const CsvRows& rows : files) {
    if (!options.resample) require_step(rows, options.dt, target.dt);
    target.rollouts.push_back(options.resample
                                  ? resampled_rollout(rows, *options.resample)
                                  : Rollout{"", rows.state_values, rows.action_values});
  }
  return target;
}

// Those of the files; where two are the same, with the folder before it.
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

std::string note_of_resampling(const std::vector<CsvRows>& files, double dt) {
  TimeSteps all = steps_of(files.front().times);
  for (const CsvRows& rows : files) {
    const TimeSteps steps = steps_of(rows.times);
    all.shortest = std::min(all.shortest, steps.shortest);
    all.longest = std::max(all.longest, steps.longest);
  }
  return fmt::format("resampled to {} s: steps were {:.4g} to {:.4g} s", dt, all.shortest,
                     all.longest);
}

// A grid that is much finer than the samples: lines between them count as measured, and rates are
// taken over a part of one.
Findings find_fine_grid(const std::vector<CsvRows>& files, double dt) {
  constexpr double least = 0.5;
  double usual = 0.0;  // of the slowest file
  for (const CsvRows& rows : files) usual = std::max(usual, steps_of(rows.times).median);
  if (dt >= least * usual) return {};
  return {
      warning(fmt::format("--resample {} is finer than the samples, {:.4g} s apart: straight "
                          "lines between them count as measured; give {:.3g} or more",
                          dt, usual, usual))};
}

// Lines over gaps count as measured.
Findings find_gaps(const std::vector<CsvRows>& files, double dt) {
  constexpr double most = 0.05;
  Findings found;
  for (const CsvRows& rows : files) {
    const double share = share_of_gaps(rows.times, dt);
    if (share <= most) continue;
    found.push_back(warning(
        fmt::format("{}: {:.0f} % of its time lies between samples that are further apart than "
                    "twice the usual: straight lines there, which count as measured",
                    rows.name, 100.0 * share)));
  }
  return found;
}

// A rollout that counts twice makes posteriors narrower than they are.
void require_distinct(const std::vector<std::filesystem::path>& paths) {
  auto sorted = paths;
  std::ranges::sort(sorted);
  const auto twice = std::ranges::adjacent_find(sorted);
  if (twice == sorted.end()) return;
  throw InputError(twice->string() + ": is named twice; name each rollout once");
}

// Files may be copies of each other.
void require_no_copies(const Target& target, const std::vector<std::filesystem::path>& paths) {
  for (const auto& [one, other] : copies_of(target)) {
    throw InputError(fmt::format("{}: holds the same numbers as {}; name each rollout once",
                                 paths[other].string(), paths[one].string()));
  }
}

// Of some, those that were measured; computed ones are right.
std::vector<RatePair> measured(std::vector<RatePair> pairs, const CsvRows& rows) {
  std::erase_if(pairs, [&](const RatePair& pair) {
    return std::ranges::find(rows.lacking, pair) != rows.lacking.end();
  });
  return pairs;
}

std::vector<std::string> names_of_files(const std::vector<CsvRows>& files) {
  std::vector<std::string> names;
  for (const CsvRows& rows : files) names.push_back(rows.name);
  return names;
}

std::vector<std::string> bare_names(const std::vector<std::filesystem::path>& paths) {
  std::vector<std::string> names;
  for (const std::filesystem::path& path : paths) names.push_back(path.filename().string());
  return names;
}

// What nobody asked for may be what the simulator is given.
Findings find_ignored(const CsvRows& rows) {
  if (rows.ignored.empty()) return {};
  return {note(fmt::format("not imported: {}; --states and --actions name what is",
                           join(few_shortened(rows.ignored))))};
}

// Rates are the slopes of angles also where all of a motion is in degrees; few begin beyond a turn.
Findings find_far_beginning(const Target& target, const std::vector<std::string>& files) {
  for (std::size_t h = 0; h < target.rollouts.size(); ++h) {
    for (std::size_t c = 0; c < target.state_channels.size(); ++c) {
      const auto& [label, unit] = target.state_channels[c];
      const double first = target.rollouts[h].states(0, static_cast<Index>(c));
      if (unit != "rad" || std::abs(first) <= 2.0 * std::numbers::pi) continue;
      return {warning(fmt::format(
          "{}: {} begins at {:.3g} rad, more than a turn from zero: if it is in degrees, add "
          "--scale {}=0.0174533, and the same for its rate",
          files[h], label, first, label))};
    }
  }
  return {};
}

// Motions are recorded faster than that, though not so fast; measured rates would contradict
// another clock.
Findings find_strange_clock(const Target& target, const CsvRows& rows, bool is_resampled) {
  constexpr double slow = 1.0, fast = 1e-6;  // [s]
  const std::string steps = fmt::format("{}: steps of {:.6g} s, which ", rows.name, target.dt);
  if (target.dt < fast) return {warning(steps + "no motion needs: in which unit are times?")};
  if (target.dt < slow || rate_pairs(target.state_channels).empty()) return {};
  return {
      warning(steps + "are long for a motion: if times are in ms, " +
              (rows.time.empty() ? fmt::format("give --dt {:.6g}", 1e-3 * target.dt)
                                 : fmt::format("add --scale {}=0.001{}", rows.time,
                                               is_resampled ? ", and give --resample in s" : "")))};
}

// Throws what is wrong with angles and rates, all at once, after glitches, which may be the cause;
// otherwise says what was checked, and what is probably wrong.
Findings check_rates(const Target& target, const std::vector<CsvRows>& files,
                     const Findings& glitches, bool is_resampled) {
  const CsvRows& first = files.front();
  const std::vector<std::string> names = names_of_files(files);
  const auto is_problem = [](const Finding& f) { return f.severity != Severity::note; };
  std::vector<RatePair> pairs = measured(rate_pairs(first.states), first);
  Findings found = find_turns(files);
  append(found, find_in_rates(target, pairs, names, first.time));
  if (std::ranges::any_of(found, is_problem)) {
    std::erase_if(found, std::not_fn(is_problem));
    found.insert(found.begin(), glitches.begin(), glitches.end());
    std::string problems;
    for (const Finding& finding : found) problems += finding.what + "\n";
    throw InputError(
        problems +
        "--no-rate-check imports the files as they are; simulations then start from, and are "
        "compared with, angles and rates that contradict each other, of which every run warns");
  }
  const std::vector<RatePair> likely = measured(likely_rate_pairs(first.states), first);
  Findings of_likely = find_in_rates(target, likely, names, first.time);
  if (std::ranges::any_of(of_likely, is_problem)) {
    std::erase_if(of_likely, std::not_fn(is_problem));
    for (Finding& problem : of_likely) {
      problem.what += "; nothing is wrong where these aren't a position and its rate";
    }
  }
  append(found, of_likely);
  append(found, find_leaps(target, names));
  append(found, find_strange_clock(target, first, is_resampled));
  append(found, find_far_beginning(target, names));
  if (pairs.empty() && likely.empty()) {
    found.push_back(
        note("not checked: units, signs and the order of columns, since none of them is the "
             "measured rate of another"));
  }
  return found;
}

}  // namespace

ImportedRecording import_csv(const std::vector<std::filesystem::path>& paths,
                             const CsvOptions& options) {
  if (paths.empty()) throw InputError("no CSV files to import");
  check_options(options);
  require_distinct(paths);
  std::vector<CsvRows> files = read_files(paths, options);
  ImportedRecording result{{}, find_ignored(files.front())};
  Findings& found = result.findings;
  for (const CsvRows& rows : files) {
    if (!rows.has_line_end) found.push_back(warning_of_end(rows.name));
  }
  const Findings glitches = find_glitches(files, options);
  append(found, glitches);
  append(found, unwrap_turns(files, options.unwrap));
  Target& target = result.target = even_target(files, options);
  name_rollouts(paths, target);
  require_no_copies(target, paths);
  if (options.resample) {
    found.push_back(note(note_of_resampling(files, *options.resample)));
    append(found, find_fine_grid(files, *options.resample));
    append(found, find_gaps(files, *options.resample));
  }
  const std::vector<std::string> names = names_of_files(files);
  if (options.differentiate) {
    append(found,
           compute_rates(target, files.front().lacking, names,
                         {*options.differentiate, options.at_rest, options.resample.has_value()}));
  }
  if (options.check_rates) {
    append(found, check_rates(target, files, glitches, options.resample.has_value()));
  }
  append(found, cut_rollouts(target, options.length, names));
  target.source = options.source.empty() ? join(bare_names(paths)) : options.source;
  target.check(paths.front().string());
  return result;
}

}  // namespace npdr::pipeline
