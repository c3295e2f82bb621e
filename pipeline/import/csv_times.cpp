#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/quantile.h"
#include "pipeline/import/csv_rows.h"

namespace npdr::pipeline {
namespace {

// Rounded times (0.033, 0.067, 0.1) are fine, a lost sample is not.
constexpr double kTimeTolerance = 0.05;
// Means of clocks that are the same, but for what rounded times at both ends leave open.
constexpr double kStepTolerance = 1e-3;
// A straight line may stand for a few lost samples, not for more of the motion.
constexpr double kLongestGap = 10.0;
// Part of a step that the duration may lack for one more: rounded times.
constexpr double kRounding = 1e-3;
// Straight lines say nothing new, but fill the memory.
constexpr double kMostRowsPerRow = 1000.0;

std::vector<double> steps_between(const std::vector<double>& times) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  return steps;
}

// "run.csv:12: column 1 't'": of a row.
std::string place_of(const CsvRows& rows, std::size_t row) {
  return fmt::format("{}:{}: {}", rows.name, row + 2, rows.time_place);
}

// Advice where times increase unevenly.
std::string resample_hint(const TimeSteps& steps) {
  if (steps.longest > kLongestGap * steps.median) {
    return fmt::format("; its steps are {:.4g} to {:.4g} s: cut the file where too much is missing",
                       steps.shortest, steps.longest);
  }
  return fmt::format("; its steps are {:.4g} to {:.4g} s: --resample {:.3g} interpolates",
                     steps.shortest, steps.longest, steps.median);
}

// A lost line is found where it is missing.
void require_steps(const CsvRows& rows, double least, double most, const std::string& advice) {
  const std::vector<double> steps = steps_between(rows.times);
  const auto refuse = [&](auto step, const std::string& problem) {
    if (step == steps.end()) return;
    const auto row = static_cast<std::size_t>(step - steps.begin()) + 1;
    throw InputError(
        fmt::format("{} is {:.6g} after the line before{}", place_of(rows, row), *step, problem));
  };
  refuse(std::ranges::find_if(steps, [](double step) { return !(step > 0.0); }),
         ": times must increase; remove the row if it is repeated");
  refuse(std::ranges::find_if(steps, [&](double step) { return step < least || step > most; }),
         fmt::format(", must be {:.4g} to {:.4g}{}", least, most, advice));
}

bool is_same_step(const CsvRows& rows, double step, double dt) {
  const double rounding = 2.0 * kTimeTolerance / static_cast<double>(rows.times.size() - 1);
  return std::abs(step - dt) <= (kStepTolerance + rounding) * dt;
}

// Mean step of equally spaced times.
double mean_step(const CsvRows& rows) {
  const std::vector<double>& times = rows.times;
  const TimeSteps steps = steps_of(times);
  const std::string advice = ": times must be equally spaced" + resample_hint(steps);
  require_steps(rows, (1.0 - 2.0 * kTimeTolerance) * steps.median,
                (1.0 + 2.0 * kTimeTolerance) * steps.median, advice);
  const double dt = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  for (std::size_t row = 0; row < times.size(); ++row) {
    const double expected = times.front() + static_cast<double>(row) * dt;
    if (std::abs(times[row] - expected) <= kTimeTolerance * dt) continue;
    throw InputError(fmt::format("{} = {}, must be {:.6g}{}", place_of(rows, row), times[row],
                                 expected, advice));
  }
  return dt;
}

// `given`, with which the times must agree, or their mean step.
double step_of(const CsvRows& rows, const std::optional<double>& given) {
  if (rows.times.empty()) return given.value();
  const double dt = mean_step(rows);
  if (given && !is_same_step(rows, dt, *given)) {
    throw InputError(
        fmt::format("{}: its times are {:.6g} s apart, but --dt says {} s: leave out --dt, or "
                    "rename {} if it is no clock",
                    rows.name, dt, *given, rows.time_place));
  }
  return given.value_or(dt);
}

// The interval between two times that holds `time`; its first row.
Index interval_of(const std::vector<double>& times, double time) {
  const auto after = std::ranges::upper_bound(times, time);
  const Index row = after - times.begin() - 1;
  return std::clamp<Index>(row, 0, static_cast<Index>(times.size()) - 2);
}

// Mean of the actions from `begin` to `begin + dt`, each of which is held until the next row's
// time.
Vector mean_action(const std::vector<double>& times, const RowMatrix& actions, double begin,
                   double dt) {
  const Index first = interval_of(times, begin);
  Vector mean = actions.row(first).transpose();  // exactly where it is held all the while
  for (Index row = first + 1; row < actions.rows(); ++row) {
    const double switched = times[static_cast<std::size_t>(row)] - begin;
    if (switched >= dt) break;
    mean += (1.0 - switched / dt) * (actions.row(row) - actions.row(row - 1)).transpose();
  }
  return mean;
}

Index num_steps_of(const CsvRows& rows, double dt) {
  const double steps = (rows.times.back() - rows.times.front()) / dt;
  const double most = kMostRowsPerRow * static_cast<double>(rows.times.size());
  const double whole = std::floor(steps + kRounding);
  if (whole >= 1.0 && steps <= most) return static_cast<Index>(whole);
  throw InputError(
      fmt::format("{}: --resample {} makes {:.3g} steps of {} rows, must make 1 to "
                  "{:.0f}",
                  rows.name, dt, steps, rows.times.size(), most));
}

}  // namespace

TimeSteps steps_of(const std::vector<double>& times) {
  std::vector<double> steps = steps_between(times);
  std::ranges::sort(steps);
  return {steps.front(), quantile_of_sorted(steps, 0.5, Between::upper), steps.back()};
}

double even_step(const std::vector<CsvRows>& files, const std::optional<double>& given) {
  double dt = 0.0;
  for (const CsvRows& rows : files) {
    const double step = step_of(rows, given);
    if (&rows == &files.front()) dt = step;
    if (rows.times.empty() || is_same_step(rows, step, dt)) continue;
    throw InputError(fmt::format(
        "{}: its times are {:.6g} s apart, those of the first file {:.6g} s; --resample {:.3g} "
        "makes them alike, unless one of the two is in another unit",
        rows.name, step, dt, std::max(step, dt)));
  }
  return dt;
}

Rollout resampled(const CsvRows& rows, const Rollout& rollout, double dt) {
  const double usual = std::max(steps_of(rows.times).median, dt);
  require_steps(rows, 0.0, kLongestGap * usual, "; cut the file where too much is missing");
  const Index num_steps = num_steps_of(rows, dt);
  const std::vector<double>& times = rows.times;
  const RowMatrix &states = rollout.states, &actions = rollout.actions;
  Rollout even{rollout.name, RowMatrix(num_steps + 1, states.cols()),
               RowMatrix(num_steps, actions.cols())};
  for (Index k = 0; k <= num_steps; ++k) {
    const double time = times.front() + static_cast<double>(k) * dt;
    const Index row = interval_of(times, time);
    const double begin = times[static_cast<std::size_t>(row)];
    const double length = times[static_cast<std::size_t>(row + 1)] - begin;
    const double part = std::clamp((time - begin) / length, 0.0, 1.0);
    even.states.row(k) = (1.0 - part) * states.row(row) + part * states.row(row + 1);
    if (k == num_steps) break;
    even.actions.row(k) = mean_action(times, actions, time, dt).transpose();
  }
  return even;
}

}  // namespace npdr::pipeline
