#include "pipeline/store/csv_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <system_error>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/store/csv_line.h"

namespace npdr::pipeline {
namespace {

bool is_blank(const std::string& line) { return trimmed(line).empty(); }

// The next line without its end, LF or CRLF.
bool next_line(std::istream& stream, std::string& line) {
  if (!std::getline(stream, line)) return false;
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return true;
}

// "theta [rad]"; anything else has no unit. Other separators than commas end up in a label.
Channel parse_channel(const std::string& field) {
  const std::size_t open = field.rfind('[');
  if (open == std::string::npos || field.back() != ']') return {field, ""};
  if (field.find_first_of("];\t") < open) return {field, ""};
  return {trimmed(field.substr(0, open)), trimmed(field.substr(open + 1, field.size() - open - 2))};
}

}  // namespace

CsvFile::CsvFile(const std::filesystem::path& path) : name_(path.string()) {
  std::error_code unreadable;
  if (std::filesystem::is_directory(path, unreadable))
    throw InputError(name_ + ": is a folder, must be a file");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(name_ + ": can't be opened; does it exist and may you read it?");
  std::string line;
  if (!next_line(stream, line)) throw InputError(name_ + ": is empty");
  if (line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
  read_header(line);
  std::size_t line_number = 1;
  std::size_t blank = 0;  // the first empty line: a row may not follow it
  while (next_line(stream, line)) {
    ++line_number;
    if (is_blank(line)) {
      if (blank == 0) blank = line_number;
      continue;
    }
    if (blank != 0) fail(blank, "is empty, but rows follow; remove it");
    read_row(line, line_number);
  }
  if (stream.bad()) throw InputError(name_ + ": reading failed");
}

void CsvFile::read_header(const std::string& line) {
  for (const std::string& field : csv_fields(line, place(1))) {
    const Channel channel = parse_channel(field);
    if (channel.label.empty() || channel.unit.empty()) {
      fail(1, fmt::format("column {} is headed {}, must be 'label [unit]', such as 'theta [rad]' "
                          "or 'gain [1]', with commas between columns",
                          columns_.size() + 1, quoted(field)));
    }
    if (find(channel.label)) {
      fail(1, fmt::format("column {} is a second one headed {}", columns_.size() + 1,
                          quoted(channel.label)));
    }
    columns_.push_back(channel);
  }
}

void CsvFile::read_row(const std::string& line, std::size_t line_number) {
  rows_.push_back(csv_fields(line, place(line_number)));
  if (rows_.back().size() != columns_.size()) {
    fail(line_number, fmt::format("has {} columns, must have {} like the header",
                                  rows_.back().size(), columns_.size()));
  }
}

std::optional<std::size_t> CsvFile::find(const std::string& label) const {
  const auto found = std::find_if(columns_.begin(), columns_.end(),
                                  [&](const Channel& c) { return c.label == label; });
  if (found == columns_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns_.begin());
}

std::size_t CsvFile::column_of(const Channel& channel) const {
  const auto column = find(channel.label);
  if (!column) {
    std::vector<std::string> labels;
    for (const Channel& known : columns_) labels.push_back(known.label);
    fail(1, missing_name("column", channel.label, labels));
  }
  const std::string& unit = columns_[*column].unit;
  if (!channel.unit.empty() && unit != channel.unit) {
    fail(1, fmt::format("column {} '{}' is in [{}], must be in [{}]", *column + 1, channel.label,
                        unit, channel.unit));
  }
  return *column;
}

double CsvFile::number(Index row, std::size_t column) const {
  const std::string& field = rows_[static_cast<std::size_t>(row)][column];
  const char* const begin = field.data() + (field.starts_with('+') ? 1 : 0);
  const char* const end = field.data() + field.size();
  double value = 0.0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value)) {
    fail(static_cast<std::size_t>(row) + 2,
         fmt::format("column {} '{}' = {}, must be a finite number", column + 1,
                     columns_[column].label, quoted(field)));
  }
  return value;
}

bool CsvFile::is_missing(Index row, std::size_t column) const {
  const std::string& field = rows_[static_cast<std::size_t>(row)][column];
  return field.empty() || field == "nan" || field == "NaN" || field == "NAN";
}

std::string CsvFile::place(std::size_t line_number) const {
  return fmt::format("{}:{}", name_, line_number);
}

void CsvFile::fail(std::size_t line_number, const std::string& message) const {
  throw InputError(fmt::format("{}: {}", place(line_number), message));
}

}  // namespace npdr::pipeline
