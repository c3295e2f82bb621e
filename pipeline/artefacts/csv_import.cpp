#include "pipeline/artefacts/csv_import.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/store/number_table.h"

namespace npdr::pipeline {
namespace {

// Rounded times (0.033, 0.067, 0.1) are fine, a lost sample is not.
constexpr double kTimeTolerance = 0.05;

// The column of a channel; its unit may be any when the channel's is "".
std::size_t column_of(const NumberTable& table, const Channel& channel) {
  const std::vector<Channel>& columns = table.columns();
  const auto column = std::ranges::find(columns, channel.label, &Channel::label);
  if (column == columns.end()) {
    std::vector<std::string> labels;
    for (const Channel& known : columns) labels.push_back(known.label);
    throw InputError(table.name() + ":1: " + missing_name("column", channel.label, labels));
  }
  const auto index = static_cast<std::size_t>(column - columns.begin());
  if (!channel.unit.empty() && column->unit != channel.unit) {
    throw InputError(fmt::format("{}:1: column {} '{}' is in [{}], must be in [{}]", table.name(),
                                 index + 1, channel.label, column->unit, channel.unit));
  }
  return index;
}

std::optional<std::size_t> time_column(const NumberTable& table) {
  for (const char* label : {"t", "time"}) {
    if (std::ranges::count(table.columns(), label, &Channel::label) == 0) continue;
    return column_of(table, {label, "s"});
  }
  return std::nullopt;
}

// The columns of one file that are taken.
struct Columns {
  std::vector<std::size_t> states, actions;
  std::optional<std::size_t> time;
};

Columns taken_columns(const NumberTable& table, const CsvOptions& options) {
  Columns columns;
  for (const Channel& c : options.channels.states) columns.states.push_back(column_of(table, c));
  for (const Channel& c : options.channels.actions) columns.actions.push_back(column_of(table, c));
  columns.time = time_column(table);
  if (columns.time || options.dt) return columns;
  throw InputError(table.name() + ":1: no column 't [s]' or 'time [s]'; give the time between " +
                   "two rows with --dt");
}

// Values of these columns, row by row.
struct Rows {
  Index count = 0;
  std::vector<double> states, actions, times;
};

// The last row's actions come after the last state: they may be missing, but must not be rubbish.
Rows read_rows(NumberTable& table, const Columns& columns) {
  Rows rows;
  std::optional<InputError> gap;
  for (; table.next(); ++rows.count) {
    if (gap) throw *gap;
    for (const std::size_t c : columns.states) rows.states.push_back(table.finite_number(c));
    for (const std::size_t c : columns.actions) {
      const bool is_missing = table.is_missing(c);
      if (is_missing && !gap) gap = table.problem(c, "a finite number");
      rows.actions.push_back(is_missing ? 0.0 : table.finite_number(c));
    }
    if (columns.time) rows.times.push_back(table.finite_number(*columns.time));
  }
  if (rows.count >= 2) return rows;
  throw InputError(fmt::format("{}: has {} rows below its header, must have at least 2",
                               table.name(), rows.count));
}

// A lost line is found where it is missing.
void check_steps(const std::string& where, const std::string& column,
                 const std::vector<double>& times) {
  std::vector<double> steps(times.size());
  std::adjacent_difference(times.begin(), times.end(), steps.begin());
  steps.erase(steps.begin());
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] > 0.0 && std::abs(steps[i] - *middle) <= 2.0 * kTimeTolerance * *middle) continue;
    throw InputError(fmt::format(
        "{}:{}: {} is {:.6g} after the line before, elsewhere {:.6g}: times must be equally spaced "
        "and increase",
        where, i + 3, column, steps[i], *middle));
  }
}

// Mean step of equally spaced times.
double mean_step(const std::string& where, const std::string& column,
                 const std::vector<double>& times) {
  check_steps(where, column, times);
  const double dt = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  for (std::size_t row = 0; row < times.size(); ++row) {
    const double expected = times.front() + static_cast<double>(row) * dt;
    if (std::abs(times[row] - expected) <= kTimeTolerance * dt) continue;
    throw InputError(
        fmt::format("{}:{}: {} = {}, must be {:.6g}: times must be equally spaced and increase",
                    where, row + 2, column, times[row], expected));
  }
  return dt;
}

double time_step(const NumberTable& table, const Columns& columns, const Rows& rows,
                 std::optional<double> given) {
  if (!columns.time) return given.value();
  const std::string column =
      fmt::format("column {} '{}'", *columns.time + 1, table.columns()[*columns.time].label);
  const double dt = mean_step(table.name(), column, rows.times);
  if (given && std::abs(dt - *given) > kTimeTolerance * *given) {
    throw InputError(fmt::format("{}: its times are {:.6g} s apart, but --dt says {} s",
                                 table.name(), dt, *given));
  }
  return given.value_or(dt);
}

std::vector<Channel> channels_at(const NumberTable& table,
                                 const std::vector<std::size_t>& columns) {
  std::vector<Channel> channels;
  for (const std::size_t column : columns) channels.push_back(table.columns()[column]);
  return channels;
}

struct CsvRollout {
  double dt;
  std::vector<Channel> states;
  std::vector<Channel> actions;
  Rollout rollout;
};

CsvRollout read_file(const std::filesystem::path& path, const CsvOptions& options) {
  NumberTable table(path, Header::with_units);
  const Columns columns = taken_columns(table, options);
  const Rows rows = read_rows(table, columns);
  const auto matrix = [](const std::vector<double>& values, Index count, std::size_t width) {
    return RowMatrix(Eigen::Map<const RowMatrix>(values.data(), count, static_cast<Index>(width)));
  };
  return {.dt = time_step(table, columns, rows, options.dt),
          .states = channels_at(table, columns.states),
          .actions = channels_at(table, columns.actions),
          .rollout = {path.stem().string(), matrix(rows.states, rows.count, columns.states.size()),
                      matrix(rows.actions, rows.count - 1, columns.actions.size())}};
}

// Every file must be a rollout of the same system, sampled alike, and as long as the first.
void require_alike(const std::string& name, const CsvRollout& csv, const Target& target) {
  check_channels(name + ": states", csv.states, target.state_channels);
  check_channels(name + ": actions", csv.actions, target.action_channels);
  if (std::abs(csv.dt - target.dt) > kTimeTolerance * target.dt) {
    throw InputError(
        fmt::format("{}: its times are {:.6g} s apart, those of the first file {:.6g} s", name,
                    csv.dt, target.dt));
  }
  if (csv.rollout.num_steps() != target.num_steps()) {
    throw InputError(fmt::format("{}: has {} rows, the first file has {}; cut the longer ones",
                                 name, csv.rollout.num_steps() + 1, target.num_steps() + 1));
  }
}

}  // namespace

Target import_csv(const std::vector<std::filesystem::path>& files, const CsvOptions& options) {
  if (files.empty()) throw InputError("no CSV files to import");
  if (options.dt && !(*options.dt > 0.0 && std::isfinite(*options.dt))) {
    throw InputError(fmt::format("--dt = {}, must be a time > 0 [s]", *options.dt));
  }
  if (options.channels.states.empty()) throw InputError("no states to import: name their columns");
  Target target;
  std::vector<std::string> names;
  for (const std::filesystem::path& path : files) {
    CsvRollout csv = read_file(path, options);
    if (target.rollouts.empty()) {
      target.dt = csv.dt;
      target.state_channels = csv.states;
      target.action_channels = csv.actions;
    } else {
      require_alike(path.string(), csv, target);
    }
    target.rollouts.push_back(std::move(csv.rollout));
    names.push_back(path.filename().string());
  }
  target.source = options.source.empty() ? join(names) : options.source;
  target.check(files.front().string());
  return target;
}

}  // namespace npdr::pipeline
