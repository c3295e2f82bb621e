#include "pipeline/config/constraint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "core/printable.h"
#include "core/text.h"

namespace npdr::pipeline {
namespace {

constexpr double kMaxCount = 1e9;

bool is_control(char c) { return std::iscntrl(static_cast<unsigned char>(c)) != 0; }

bool is_plain(const std::string& text, std::size_t max_size) {
  return !text.empty() && text.size() <= max_size &&
         std::none_of(text.begin(), text.end(), is_control);
}

bool is_label(const std::string& text) {
  return is_plain(text, 100) && printable_line(text) == text;
}

bool is_folder_character(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.';
}

}  // namespace

Constraint<double> positive() {
  return {"> 0", [](double v) { return v > 0.0; }};
}

Constraint<double> between(const Range& range) {
  return {fmt::format(">= {} and <= {}", range.low, range.high),
          [range](double v) { return range.contains(v); }};
}

Constraint<double> between(double low, double high) { return between(Range{low, high}); }

Constraint<double> interval(const std::string& above, double low, const std::string& below,
                            double high) {
  const bool has_low = above == ">=", has_high = below == "<=";
  return {fmt::format("{} {} and {} {}", above, low, below, high), [=](double v) {
            return (has_low ? v >= low : v > low) && (has_high ? v <= high : v < high);
          }};
}

Constraint<double> count_from(double low) {
  return {fmt::format(">= {} and <= 10^9", low),
          [=](double v) { return v >= low && v <= kMaxCount; }};
}

Constraint<double> not_negative() {
  return {">= 0", [](double v) { return v >= 0.0; }};
}

Constraint<std::string> one_of(std::vector<std::string> names) {
  std::string words = "one of " + join(names);
  auto allows = [names](const std::string& value) {
    return std::find(names.begin(), names.end(), value) != names.end();
  };
  return {std::move(words), std::move(allows), std::move(names)};
}

Constraint<std::string> label() {
  return {"1 to 100 characters, none of them a control character", is_label};
}

Constraint<std::map<std::string, double>> few_numbers() {
  return {"of at most 1000 numbers", [](const auto& numbers) { return numbers.size() <= 1000; }};
}

Constraint<std::string> folder_name() {
  return {"a folder name of 1 to 100 letters, digits, '_', '-' and '.' that doesn't begin with '.'",
          [](const std::string& text) {
            return is_label(text) && text.front() != '.' &&
                   std::all_of(text.begin(), text.end(), is_folder_character);
          }};
}

Constraint<std::string> file_path() {
  return {"a path without control characters",
          [](const std::string& text) { return is_plain(text, 4096); }};
}

Constraint<std::string> column_name() {
  return {
      "made of letters, digits, '_', '-' and '.', the first one a letter or '_'",
      [](const std::string& text) {
        return is_label(text) && std::all_of(text.begin(), text.end(), is_folder_character) &&
               (std::isalpha(static_cast<unsigned char>(text.front())) != 0 || text.front() == '_');
      }};
}

Constraint<std::string> shell_command() {
  return {"a command for the shell", [](const std::string& text) {
            const auto is_bad = [](char c) { return is_control(c) && c != '\n' && c != '\t'; };
            return text.size() <= 65'536 && text.find_first_not_of(" \t\n") != std::string::npos &&
                   std::none_of(text.begin(), text.end(), is_bad);
          }};
}

}  // namespace npdr::pipeline
