#include "pipeline/config/constraint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "core/printable.h"
#include "core/text.h"

namespace npdr::pipeline {
namespace {

constexpr double kMaxCount = 1e9;

template <class T>
bool all_distinct(const std::vector<T>& values) {
  return std::set<T>(values.begin(), values.end()).size() == values.size();
}

// Whether there are no control characters but `others`.
bool is_plain(const std::string& text, std::size_t max_size, std::string_view others = "") {
  return text.size() <= max_size && std::ranges::none_of(text, [&](char c) {
           const bool is_control = static_cast<unsigned char>(c) < 0x20 || c == '\x7f';
           return is_control && others.find(c) == std::string_view::npos;
         });
}

bool is_line(const std::string& text) { return is_plain(text, 4096, "\t"); }

bool is_label(const std::string& text) {
  return !text.empty() && is_plain(text, 100) && printable_line(text) == text;
}

bool is_name(const std::string& text) {
  return is_label(text) && std::ranges::all_of(text, [](unsigned char c) {
           return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
         });
}

// Whether a text is made of `least` to `most` digits.
bool is_number(std::string_view text, std::size_t least, std::size_t most) {
  return text.size() >= least && text.size() <= most &&
         text.find_first_not_of("0123456789") == std::string_view::npos;
}

// Options of sbatch that ask for resources, or say when a job may start; all others may change what
// a job runs, where it writes, or how it is found again.
bool is_option(const std::string& text) {
  static const std::vector<std::string> allowed = split(
      "account begin bb bbf constraint contiguous core-spec "
      "cores-per-socket cpu-freq cpus-per-gpu deadline delay-boot distribution exclude exclusive "
      "extra-node-info gpu-bind gpu-freq gpus gpus-per-node gpus-per-task gres gres-flags hint "
      "hold licenses mail-type mcs-label mem mem-bind mem-per-cpu mem-per-gpu mincpus network nice "
      "nodelist nodes oversubscribe partition power prefer priority profile propagate qos reboot "
      "reservation sockets-per-node spread-job switches thread-spec threads-per-core time-min tmp "
      "tres-bind tres-per-task use-min-nodes wckey A B b C F G H L m N p q S s w x",
      ' ');
  const auto is_upper = [](unsigned char c) { return std::isupper(c) != 0; };
  const bool is_long = text.starts_with("--");
  if (!is_line(text) || !text.starts_with('-') || text.find(' ') != std::string::npos) return false;
  const std::size_t begin = is_long ? 2 : 1, end = is_long ? text.find('=') : 2;
  const std::string name = text.substr(begin, end - begin);
  const std::string value = end < text.size() ? text.substr(end) : "";
  if (std::ranges::find(allowed, name) == allowed.end()) return false;
  if (is_long) return value != "=" && std::ranges::none_of(name, is_upper);
  const bool is_flag = name == "H" || name == "s";  // others could follow in one word
  return value.find('=') == std::string::npos && !(is_flag && !value.empty());
}

}  // namespace

Constraint<double> interval(End lower, double low, double high, End upper) {
  const bool has_low = lower == End::closed, has_high = upper == End::closed;
  std::string words = fmt::format("{} {}", has_low ? ">=" : ">", low);
  if (std::isfinite(high)) words += fmt::format(" and {} {}", has_high ? "<=" : "<", high);
  return {words, [=](double v) {
            return (has_low ? v >= low : v > low) && (has_high ? v <= high : v < high);
          }};
}

Constraint<double> count_from(double low) {
  return {fmt::format(">= {} and <= 10^9", low), between(low, kMaxCount).allows};
}

Constraint<double> window_constraint() {
  return {"odd, >= 5 and <= 1001",
          [](double v) { return v >= 5.0 && v <= 1001.0 && static_cast<Index>(v) % 2 == 1; }};
}

Constraint<double> folds_constraint() {
  return {"0 or >= 2", [](double folds) { return folds == 0.0 || folds >= 2.0; }};
}

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

Constraint<std::vector<double>> noise_prior(double low, const std::string& name, double high) {
  const Constraint<double> median = interval(End::open, low, high, End::open);
  return {fmt::format("[median, deviation] with a {} {} and a deviation > 0", name, median.words),
          [allows = median.allows](const auto& prior) {
            return prior.size() == 2 && allows(prior[0]) && prior[1] > 0.0;
          }};
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

Constraint<std::vector<std::uint64_t>> shape_constraint() {
  return {"three numbers of 1 to 10^6: items, steps, values; or none", [](const auto& shape) {
            constexpr std::uint64_t most = 1'000'000;
            const auto is_size = [](std::uint64_t size) { return size >= 1 && size <= most; };
            return shape.empty() || (shape.size() == 3 && std::ranges::all_of(shape, is_size));
          }};
}

std::string marginal_words() {
  return "{ uniform = [low, high] }, { log_uniform = [low, high] }, { normal = [mean, std] }, "
         "{ log_normal = [mean of log, std of log] }, { gamma = [shape, scale] } or { beta = [a, "
         "b] "
         "}, of finite numbers";
}

Constraint<std::vector<inference::Marginal>> prior_constraint() {
  return {fmt::format("of 1 to {} parameters", kMostParameters),
          [](const auto& prior) { return !prior.empty() && prior.size() <= kMostParameters; }};
}

Constraint<std::map<std::string, double>> few_numbers() {
  return {"of at most 1000 numbers", [](const auto& numbers) { return numbers.size() <= 1000; }};
}

Constraint<std::string> one_of(std::vector<std::string> names) {
  const auto allows = [names](const std::string& value) {
    return std::ranges::find(names, value) != names.end();
  };
  return {"one of " + join(names), allows, names};
}

Constraint<std::vector<std::string>> distinct_of(const std::vector<std::string>& known,
                                                 int fewest) {
  return {"distinct, each one of " + join(known) + (fewest > 0 ? ", at least one of them" : ""),
          [fewest, allows = one_of(known).allows](const auto& names) {
            return std::ssize(names) >= fewest && all_distinct(names) &&
                   std::ranges::all_of(names, allows);
          }};
}

Constraint<std::string> label() {
  return {"1 to 100 characters, none of them a control character", is_label};
}

Constraint<std::string> folder_name() {
  return {"a folder name of 1 to 100 letters, digits, '_', '-' and '.' that doesn't begin with '.'",
          [](const std::string& text) { return is_name(text) && text.front() != '.'; }};
}

Constraint<std::string> column_name() {
  return {"made of letters, digits, '_', '-' and '.', the first one a letter or '_'",
          [](const std::string& text) {
            return is_name(text) && (std::isalpha(static_cast<unsigned char>(text.front())) != 0 ||
                                     text.front() == '_');
          }};
}

Constraint<std::string> file_path() {
  return {"a path without control characters",
          [](const std::string& text) { return !text.empty() && is_plain(text, 4096); }};
}

Constraint<std::string> shell_command() {
  return {"a command for the shell", [](const std::string& text) {
            return text.find_first_not_of(" \t\n") != std::string::npos &&
                   is_plain(text, 65'536, "\n\t");
          }};
}

Constraint<std::vector<std::string>> shell_lines() {
  return {"lines of shell without control characters",
          [](const auto& lines) { return std::ranges::all_of(lines, is_line); }};
}

Constraint<std::string> memory_constraint() {
  return {"a size such as 500M or 2G", [](const std::string& text) {
            const std::size_t digits = text.find_last_not_of("KMGT") + 1;  // of npos: 0
            return text.empty() ||
                   (is_number(text.substr(0, digits), 1, 9) && text.size() - digits <= 1);
          }};
}

Constraint<std::string> time_constraint() {
  return {"a time such as 90 (minutes), 01:30:00 or 1-12:00 (days-hours:minutes)",
          [](const auto& text) { return text.empty() || seconds_of(text).has_value(); }};
}

std::optional<double> seconds_of(const std::string& time) {
  const std::size_t dash = time.find('-');
  const bool has_days = dash != std::string::npos;
  const std::vector<std::string> clock = split(has_days ? time.substr(dash + 1) : time, ':');
  if (clock.empty() || clock.size() > 3 || time.ends_with(':')) return std::nullopt;
  if (has_days && !is_number(time.substr(0, dash), 1, 4)) return std::nullopt;
  const std::size_t most = has_days ? 2 : clock.size() == 1 ? 7 : 5;
  double seconds = 0.0;
  for (const std::string& part : clock) {
    const bool is_first = &part == &clock.front();
    if (!is_number(part, is_first ? 1 : 2, is_first ? most : 2)) return std::nullopt;
    seconds = seconds * 60.0 + std::stod(part);
  }
  // The first part is hours, or minutes where there are no days and at most two parts.
  for (std::size_t i = clock.size(); i < (has_days ? 3 : 2); ++i) seconds *= 60.0;
  return seconds + (has_days ? 86'400.0 * std::stod(time) : 0.0);
}

Constraint<std::string> option_value() {
  return {"one word of printable characters without quotes", [](const std::string& text) {
            return is_plain(text, 4096) && text.find_first_of(" \"'`") == std::string::npos;
          }};
}

Constraint<std::vector<std::string>> options_constraint() {
  return {
      "options such as --qos=long, each of one word, that ask for resources or say when a job may "
      "start; none that change what it runs, or where it writes",
      [](const auto& options) { return std::ranges::all_of(options, is_option); }};
}

}  // namespace npdr::pipeline
