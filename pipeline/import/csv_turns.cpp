#include "pipeline/import/csv_turns.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/import/angle_wraps.h"

namespace npdr::pipeline {
namespace {

Index position_of(const std::vector<Channel>& states, const std::string& label) {
  const auto state = std::ranges::find(states, label, &Channel::label);
  if (state != states.end()) return state - states.begin();
  std::vector<std::string> labels;
  for (const Channel& channel : states) labels.push_back(channel.label);
  throw InputError("--unwrap: " + unknown_name("state", label, labels));
}

double turn_of(const Channel& angle) {
  const std::optional<double> turn = turn_in(angle.unit);
  if (turn) return *turn;
  throw InputError(fmt::format("--unwrap {}: it is in [{}], must be in [rad] or [deg]", angle.label,
                               angle.unit));
}

// Jumps of a state in all files.
struct Jumps {
  double period = 0.0;
  Index count = 0;
  Index num_files = 0;
  std::string first;  // "run.csv:12: alpha jumps by -6.28 after the line before"
};

Jumps jumps_of(const std::vector<CsvRows>& files, Index state, const Channel& channel) {
  Jumps all;
  for (const CsvRows& rows : files) {
    const Vector angle = rows.state_values.col(state);
    const AngleJumps jumps = find_jumps(angle, channel.unit);
    if (jumps.rows.empty()) continue;
    const Index t = jumps.rows.front();
    if (all.count == 0) {
      all.first = fmt::format("{}:{}: {} jumps by {:.4g} after the line before", rows.name, t + 3,
                              channel.label, angle(t + 1) - angle(t));
      all.period = jumps.period;
    }
    all.count += static_cast<Index>(jumps.rows.size());
    ++all.num_files;
  }
  return all;
}

std::string problem_of(const Jumps& jumps, const Channel& channel) {
  const bool is_degrees = channel.unit == "rad" && jumps.period > turn_of(channel);
  const std::string found =
      fmt::format("{} ({} in {}), a whole turn", jumps.first, counted(jumps.count, "such jump"),
                  counted(jumps.num_files, "file"));
  if (!is_degrees) return fmt::format("{}: it wraps; add --unwrap {}", found, channel.label);
  return fmt::format(
      "{} of degrees, though its unit says [rad]: it wraps; add --scale {}=0.0174533 --unwrap {}",
      found, channel.label, channel.label);
}

}  // namespace

Findings unwrap_turns(std::vector<CsvRows>& files, const std::vector<std::string>& labels) {
  Findings found;
  for (const std::string& label : labels) {
    const Index state = position_of(files.front().states, label);
    const double turn = turn_of(files.front().states[static_cast<std::size_t>(state)]);
    Index count = 0;
    for (CsvRows& rows : files) count += unwrap(rows.state_values.col(state), turn);
    found.push_back(note(
        fmt::format("unwrapped {}: {} of a whole turn taken out", label, counted(count, "jump"))));
  }
  return found;
}

Findings find_turns(const std::vector<CsvRows>& files) {
  Findings found;
  const std::vector<Channel>& states = files.front().states;
  for (std::size_t c = 0; c < states.size(); ++c) {
    const Jumps jumps = jumps_of(files, static_cast<Index>(c), states[c]);
    if (jumps.count > 0) found.push_back(warning(problem_of(jumps, states[c])));
  }
  return found;
}

}  // namespace npdr::pipeline
