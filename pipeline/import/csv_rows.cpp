#include "pipeline/import/csv_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <functional>
#include <optional>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/store/column_labels.h"
#include "pipeline/store/number_table.h"

namespace npdr::pipeline {
namespace {

constexpr const char* kNoHoles =
    "a finite number: cut the rollout there or, where there are times, remove the row and pass "
    "--resample DT";

// A column that is taken; none: it is to be computed.
struct Column {
  std::optional<std::size_t> index;
  double factor = 1.0;
  Channel channel;
  bool is_guess = false;  // of a clock beside --dt: it is none unless it increases

  double number(const NumberTable& table) const {
    return index ? factor * table.finite_number(*index, kNoHoles) : 0.0;
  }
};

struct Columns {
  std::vector<Column> states, actions;
  std::optional<Column> time;
};

// Finds the columns of one file.
class ColumnFinder {
 public:
  ColumnFinder(const NumberTable& table, const CsvOptions& options)
      : table_(table), options_(options), labels_(labels_of(table.columns())) {}

  Columns all() const {
    Columns columns;
    for (const Channel& channel : options_.channels.states) {
      columns.states.push_back(state(channel));
    }
    for (const Channel& channel : options_.channels.actions) {
      columns.actions.push_back(column(channel));
    }
    columns.time = time();
    check_scales(columns);
    return columns;
  }

  std::vector<std::string> ignored_by(const Columns& columns) const {
    std::vector<std::string> ignored = labels_;
    for (const std::string& taken : taken_by(columns)) std::erase(ignored, taken);
    return ignored;
  }

 private:
  bool has(const std::string& label) const { return std::ranges::count(labels_, label) > 0; }

  // A rate without a column is computed of its position.
  Column state(const Channel& channel) const {
    if (has(channel.label)) return column(channel);
    for (const Channel& position : options_.channels.states) {
      if (channel.label != position.label + "_dot" || !has(position.label)) continue;
      const bool is_rate = is_rate_of(channel, position);
      if (is_rate && options_.differentiate) {
        return {{}, 1.0, {channel.label, rate_unit(column(position).channel.unit)}};
      }
      throw InputError(fmt::format(
          "{}; --differentiate computes it of '{}'{}", lack_of(channel.label), position.label,
          is_rate ? ""
                  : fmt::format(" in [{}], not in [{}]", rate_unit(position.unit), channel.unit)));
    }
    throw InputError(lack_of(channel.label));
  }

  std::string lack_of(const std::string& label) const {
    return table_.name() + ":1: " + missing_name("column", label, labels_);
  }

  const ColumnScale* scale_of(const std::string& label) const {
    const auto scale = std::ranges::find(options_.scales, label, &ColumnScale::label);
    return scale == options_.scales.end() ? nullptr : &*scale;
  }

  // The unit may be any when the channel's is "", or when the numbers are scaled.
  Column column(const Channel& channel) const {
    const auto label = std::ranges::find(labels_, channel.label);
    if (label == labels_.end()) throw InputError(lack_of(channel.label));
    const auto index = static_cast<std::size_t>(label - labels_.begin());
    const Channel& found = table_.columns()[index];
    const ColumnScale* scale = scale_of(channel.label);
    if (scale == nullptr && !channel.unit.empty() && found.unit != channel.unit) {
      throw InputError(fmt::format(
          "{}:1: column {} '{}' is in [{}], must be in [{}]; --scale {}=FACTOR "
          "converts it",
          table_.name(), index + 1, channel.label, found.unit, channel.unit, channel.label));
    }
    if (scale != nullptr && channel.unit.empty()) {
      throw InputError(
          fmt::format("--scale {}: say which unit it gives, such as '{} [rad]' among the "
                      "columns to take",
                      channel.label, channel.label));
    }
    return {index,
            scale == nullptr ? 1.0 : scale->factor,
            {channel.label, channel.unit.empty() ? found.unit : channel.unit}};
  }

  bool is_channel(const std::string& label) const {
    const auto& [states, actions] = options_.channels;
    return std::ranges::count(states, label, &Channel::label) +
               std::ranges::count(actions, label, &Channel::label) >
           0;
  }

  // By its name, such as 'Time' or 'timestamp'; no state or action.
  bool is_called_clock(const Channel& found) const {
    constexpr std::array words = {"time", "clock", "stamp", "zeit"};
    std::string name = found.label;
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
    const bool has_word = std::ranges::any_of(
        words, [&](const char* word) { return name.find(word) != std::string::npos; });
    return (name == "t" || has_word) && !is_channel(found.label);
  }

  // 't' or 'time'; else the only one in [s], as it is or by its scale, whose name is a clock's.
  std::optional<Column> time() const {
    for (const char* label : {"t", "time"}) {
      if (has(label) && !is_channel(label)) return column({label, "s"});
    }
    std::vector<std::string> clocks, in_seconds;
    for (const Channel& found : table_.columns()) {
      if (!is_called_clock(found)) continue;
      clocks.push_back(found.label);
      if (found.unit == "s" || scale_of(found.label) != nullptr) in_seconds.push_back(found.label);
    }
    if (in_seconds.size() == 1) {
      Column clock = column({in_seconds.front(), "s"});
      clock.is_guess = options_.dt.has_value();
      return clock;
    }
    if (options_.dt) return std::nullopt;
    std::string candidates;
    if (!clocks.empty()) {
      candidates = fmt::format(" (is it {}? Call it t; --scale t=FACTOR makes it seconds)",
                               join(clocks, " or "));
    }
    throw InputError(table_.name() + ":1: no column 't [s]' or 'time [s]'" + candidates +
                     (options_.resample ? ", which --resample needs"
                                        : "; give the time between two rows with --dt"));
  }

  static std::vector<std::string> taken_by(const Columns& columns) {
    std::vector<std::string> taken;
    for (const auto* list : {&columns.states, &columns.actions}) {
      for (const Column& column : *list) {
        if (column.index) taken.push_back(column.channel.label);
      }
    }
    if (columns.time) taken.push_back(columns.time->channel.label);
    return taken;
  }

  void check_scales(const Columns& columns) const {
    const std::vector<std::string> taken = taken_by(columns);
    for (const ColumnScale& scale : options_.scales) {
      if (std::ranges::find(taken, scale.label) != taken.end()) continue;
      throw InputError(table_.name() + ": --scale: " + unknown_name("column", scale.label, taken));
    }
  }

  const NumberTable& table_;
  const CsvOptions& options_;
  std::vector<std::string> labels_;
};

// Values of these columns, row by row.
struct Values {
  Index count = 0;
  std::vector<double> states, actions, times;
};

// The last row's actions come after the last state: they may be missing, but must not be rubbish.
Values read_values(NumberTable& table, const Columns& columns) {
  Values values;
  std::optional<InputError> gap;
  for (; table.next(); ++values.count) {
    if (gap) throw InputError(*gap);
    for (const Column& column : columns.states) values.states.push_back(column.number(table));
    for (const Column& column : columns.actions) {
      const bool is_missing = table.is_missing(*column.index);
      if (is_missing && !gap) gap = table.problem(*column.index, kNoHoles);
      values.actions.push_back(is_missing ? 0.0 : column.number(table));
    }
    if (columns.time) values.times.push_back(columns.time->number(table));
  }
  if (values.count >= 2) return values;
  throw InputError(fmt::format("{}: has {} below its header, must have at least 2", table.name(),
                               counted(values.count, "row")));
}

std::vector<Channel> channels_of_columns(const std::vector<Column>& columns) {
  std::vector<Channel> channels;
  for (const Column& column : columns) channels.push_back(column.channel);
  return channels;
}

RowMatrix matrix(const std::vector<double>& values, Index rows, std::size_t width) {
  return Eigen::Map<const RowMatrix>(values.data(), rows, static_cast<Index>(width));
}

}  // namespace

CsvRows read_csv_rows(const std::filesystem::path& path, const CsvOptions& options) {
  NumberTable table(path, Header::with_units, options.format);
  const ColumnFinder finder(table, options);
  Columns columns = finder.all();
  Values values = read_values(table, columns);
  if (columns.time && columns.time->is_guess &&
      std::ranges::adjacent_find(values.times, std::greater_equal()) != values.times.end()) {
    columns.time.reset();
    values.times.clear();
  }
  CsvRows rows;
  rows.name = table.name();
  rows.states = channels_of_columns(columns.states);
  rows.actions = channels_of_columns(columns.actions);
  rows.lacking = rate_pairs(rows.states);
  std::erase_if(rows.lacking, [&](const RatePair& pair) {
    return columns.states[static_cast<std::size_t>(pair.rate)].index.has_value();
  });
  if (columns.time) {
    rows.time = columns.time->channel.label;
    rows.time_place = fmt::format("column {} '{}'", *columns.time->index + 1, rows.time);
  }
  rows.times = values.times;
  rows.rollout = {rows.name, matrix(values.states, values.count, columns.states.size()),
                  matrix(values.actions, values.count - 1, columns.actions.size())};
  rows.has_line_end = table.has_line_end();
  rows.ignored = finder.ignored_by(columns);
  return rows;
}

}  // namespace npdr::pipeline
