#include "pipeline/config/field_constraints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <set>

#include "core/text.h"
#include "pipeline/config/check.h"
#include "pipeline/config/metric.h"

namespace npdr::pipeline {
namespace {

template <class T>
bool all_distinct(const std::vector<T>& values) {
  return std::set<T>(values.begin(), values.end()).size() == values.size();
}

Constraint<std::vector<std::string>> distinct_of(const std::vector<std::string>& known) {
  return {"distinct, each one of " + join(known), [known](const auto& names) {
            return all_distinct(names) && std::ranges::all_of(names, [&](const std::string& name) {
                     return std::ranges::find(known, name) != known.end();
                   });
          }};
}

bool is_visible(char c) { return static_cast<unsigned char>(c) > ' ' && c != '\x7f'; }

bool is_printable(const std::string& line) {
  return line.size() <= 4096 &&
         std::ranges::all_of(line, [](char c) { return c == '\t' || c == ' ' || is_visible(c); });
}

// Options of sbatch that ask for resources, or say when a job may start; all others may change what
// a job runs, where it writes, or how it is found again.
bool is_option(const std::string& text) {
  static const std::regex form("--([a-z-]+)(=[^ ]+)?|-([A-Za-z])([^ =]+)?");
  static const std::vector<std::string> allowed = split(
      "account begin bb bbf constraint contiguous core-spec "
      "cores-per-socket cpu-freq cpus-per-gpu deadline delay-boot distribution exclude exclusive "
      "extra-node-info gpu-bind gpu-freq gpus gpus-per-node gpus-per-task gres gres-flags hint "
      "hold licenses mail-type mcs-label mem mem-bind mem-per-cpu mem-per-gpu mincpus network nice "
      "nodelist nodes oversubscribe partition power prefer priority profile propagate qos reboot "
      "reservation sockets-per-node spread-job switches thread-spec threads-per-core time-min tmp "
      "tres-bind tres-per-task use-min-nodes wckey A B b C F G H L m N p q S s w x",
      ' ');
  std::smatch parts;
  if (!is_printable(text) || !std::regex_match(text, parts, form)) return false;
  const bool is_flag = parts[3] == "H" || parts[3] == "s";  // others could follow in one word
  const bool is_allowed = std::ranges::count(allowed, parts[1].str() + parts[3].str()) > 0;
  return is_allowed && !(is_flag && parts[4].matched);
}

}  // namespace

Constraint<std::vector<double>> noise_prior(double low, const std::string& name, double high) {
  const std::string below = std::isfinite(high) ? fmt::format(" and < {}", high) : "";
  return {fmt::format("[median, deviation] with a {} > {}{} and a deviation > 0", name, low, below),
          [low, high](const auto& prior) {
            return prior.size() == 2 && prior[0] > low && prior[0] < high && prior[1] > 0.0;
          }};
}

Constraint<double> degrees_constraint() {
  return {"> 1", [](double v) { return v > 1.0; }};
}

Constraint<double> window_constraint() {
  return {"odd, >= 5 and <= 1001",
          [](double v) { return v >= 5.0 && v <= 1001.0 && static_cast<Index>(v) % 2 == 1; }};
}

Constraint<std::vector<std::uint64_t>> seeds_constraint() {
  // Each artefact holds the whole study: more seeds would take memory and space with their square.
  constexpr std::size_t most = 1000;
  return {"distinct and >= 0, 1 to 1000 of them", [](const auto& seeds) {
            return !seeds.empty() && seeds.size() <= most && all_distinct(seeds);
          }};
}

Constraint<std::vector<std::uint64_t>> rollouts_constraint() {
  return {"distinct and >= 1, in the order in which they are used", [](const auto& rollouts) {
            return all_distinct(rollouts) && std::ranges::count(rollouts, 0u) == 0;
          }};
}

Constraint<double> folds_constraint() {
  return {"0 or >= 2", [](double folds) { return folds == 0.0 || folds >= 2.0; }};
}

Constraint<std::vector<std::string>> metrics_constraint() {
  Constraint<std::vector<std::string>> constraint = distinct_of(names_of<Metric>());
  constraint.words += ", at least one of them";
  constraint.allows = [allows = constraint.allows](const auto& metrics) {
    return !metrics.empty() && allows(metrics);
  };
  return constraint;
}

Constraint<std::vector<std::string>> checks_constraint() { return distinct_of(names_of<Check>()); }

Constraint<std::vector<double>> range_constraint() {
  return {"[low, high] with low < high", [](const auto& range) {
            return range.empty() || (range.size() == 2 && range[0] < range[1]);
          }};
}

Constraint<std::vector<double>> ascending() {
  return {"ascending", [](const auto& values) {
            return std::ranges::adjacent_find(values, std::greater_equal<>()) == values.end();
          }};
}

Constraint<std::vector<inference::Marginal>> prior_constraint() {
  return {fmt::format("of 1 to {} parameters", kMostParameters),
          [](const auto& prior) { return !prior.empty() && prior.size() <= kMostParameters; }};
}

Constraint<std::string> memory_constraint() {
  return {"a size such as 500M or 2G", [](const std::string& text) {
            static const std::regex size("[0-9]{1,9}[KMGT]?");
            return text.empty() || std::regex_match(text, size);
          }};
}

Constraint<std::string> time_constraint() {
  return {"a time such as 90 (minutes), 01:30:00 or 1-12:00 (days-hours:minutes)",
          [](const std::string& text) {
            static const std::regex time(
                "[0-9]{1,7}|[0-9]{1,5}:[0-9]{2}(:[0-9]{2})?|[0-9]{1,4}-[0-9]{1,2}(:[0-9]{2}){0,2}");
            return text.empty() || std::regex_match(text, time);
          }};
}

std::optional<double> seconds_of(const std::string& time) {
  if (time.empty()) return std::nullopt;
  std::vector<double> clock;
  const std::size_t dash = time.find('-');
  const bool has_days = dash != std::string::npos;
  for (const std::string& part : split(has_days ? time.substr(dash + 1) : time, ':')) {
    clock.push_back(std::stod(part));
  }
  if (has_days) {
    clock.resize(3, 0.0);
    clock[0] += 24.0 * std::stod(time.substr(0, dash));
  }
  if (clock.size() == 1) return clock[0] * 60.0;
  double seconds = 0.0;
  for (const double part : clock) seconds = seconds * 60.0 + part;
  return seconds;
}

Constraint<std::string> option_value() {
  return {"one word of printable characters without quotes", [](const std::string& text) {
            return text.size() <= 4096 && std::ranges::all_of(text, is_visible) &&
                   text.find_first_of("\"'`") == std::string::npos;
          }};
}

Constraint<std::vector<std::string>> options_constraint() {
  return {
      "options such as --qos=long, each of one word, that ask for resources or say when a job may "
      "start; none that change what it runs, or where it writes",
      [](const auto& options) { return std::ranges::all_of(options, is_option); }};
}

Constraint<std::vector<std::string>> shell_lines() {
  return {"lines of shell without control characters",
          [](const auto& lines) { return std::ranges::all_of(lines, is_printable); }};
}

}  // namespace npdr::pipeline
