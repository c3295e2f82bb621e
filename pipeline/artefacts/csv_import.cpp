#include "pipeline/artefacts/csv_import.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/store/csv_file.h"

namespace npdr::pipeline {
namespace {

// Rounded times (0.033, 0.067, 0.1) are fine, a lost sample is not.
constexpr double kTimeTolerance = 0.05;

// Columns of one file, resolved from labels.
std::vector<std::size_t> find_columns(const CsvFile& file, const std::vector<Channel>& wanted) {
  std::vector<std::size_t> columns;
  for (const Channel& channel : wanted) columns.push_back(file.column_of(channel));
  return columns;
}

std::vector<Channel> channels_at(const CsvFile& file, const std::vector<std::size_t>& columns) {
  std::vector<Channel> channels;
  for (const std::size_t column : columns) channels.push_back(file.columns()[column]);
  return channels;
}

RowMatrix read_rows(const CsvFile& file, const std::vector<std::size_t>& columns, Index num_rows) {
  RowMatrix values(num_rows, static_cast<Index>(columns.size()));
  for (Index row = 0; row < num_rows; ++row) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      values(row, static_cast<Index>(c)) = file.number(row, columns[c]);
    }
  }
  return values;
}

// A lost line is found where it is missing.
void check_steps(const CsvFile& file, std::size_t column) {
  std::vector<double> steps;
  for (Index row = 1; row < file.num_rows(); ++row) {
    steps.push_back(file.number(row, column) - file.number(row - 1, column));
  }
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] > 0.0 && std::abs(steps[i] - *middle) <= 2.0 * kTimeTolerance * *middle) continue;
    throw InputError(fmt::format(
        "{}:{}: column {} '{}' is {:.6g} after the line before, elsewhere {:.6g}: times must be "
        "equally spaced and increase",
        file.name(), i + 3, column + 1, file.columns()[column].label, steps[i], *middle));
  }
}

// Mean step of equally spaced times.
double time_step(const CsvFile& file, std::size_t column) {
  file.column_of({file.columns()[column].label, "s"});
  check_steps(file, column);
  const Index last = file.num_rows() - 1;
  const double start = file.number(0, column);
  const double dt = (file.number(last, column) - start) / static_cast<double>(last);
  for (Index row = 0; row <= last; ++row) {
    const double expected = start + static_cast<double>(row) * dt;
    const double found = file.number(row, column);
    if (!(std::abs(found - expected) <= kTimeTolerance * dt)) {
      throw InputError(fmt::format(
          "{}:{}: column {} '{}' = {}, must be {:.6g}: times must be equally spaced and increase",
          file.name(), row + 2, column + 1, file.columns()[column].label, found, expected));
    }
  }
  return dt;
}

double time_step(const CsvFile& file, std::optional<double> given) {
  auto column = file.find("t");
  if (!column) column = file.find("time");
  if (!column && given) return *given;
  if (!column) {
    throw InputError(file.name() + ":1: no column 't [s]' or 'time [s]'; give the time between " +
                     "two rows with --dt");
  }
  const double dt = time_step(file, *column);
  if (given && std::abs(dt - *given) > kTimeTolerance * *given) {
    throw InputError(fmt::format("{}: its times are {:.6g} s apart, but --dt says {} s",
                                 file.name(), dt, *given));
  }
  return given.value_or(dt);
}

// The last row's actions come after the last state: they may be missing, but must not be rubbish.
void check_last_actions(const CsvFile& file, const std::vector<std::size_t>& columns) {
  const Index last = file.num_rows() - 1;
  for (const std::size_t column : columns) {
    if (!file.is_missing(last, column)) file.number(last, column);
  }
}

struct CsvRollout {
  double dt;
  std::vector<Channel> states;
  std::vector<Channel> actions;
  Rollout rollout;
};

CsvRollout read_file(const std::filesystem::path& path, const CsvOptions& options) {
  const CsvFile file(path);
  if (file.num_rows() < 2) {
    throw InputError(fmt::format("{}: has {} rows below its header, must have at least 2",
                                 file.name(), file.num_rows()));
  }
  const auto states = find_columns(file, options.channels.states);
  const auto actions = find_columns(file, options.channels.actions);
  check_last_actions(file, actions);
  return {.dt = time_step(file, options.dt),
          .states = channels_at(file, states),
          .actions = channels_at(file, actions),
          .rollout = {path.stem().string(), read_rows(file, states, file.num_rows()),
                      read_rows(file, actions, file.num_rows() - 1)}};
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
