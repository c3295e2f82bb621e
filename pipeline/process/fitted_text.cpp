#include "pipeline/process/fitted_text.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "core/text.h"

namespace npdr::pipeline {
namespace {

// Columns of the character that begins with this byte of UTF-8; 0: it goes on with it.
int columns_of(char byte) {
  const auto value = static_cast<unsigned char>(byte);
  if ((value & 0xC0) == 0x80) return 0;
  return value >= 0xE3 ? 2 : 1;
}

int width_of(const std::string& text) {
  int width = 0;
  for (const char byte : text) width += columns_of(byte);
  return width;
}

// Places of the bars between a line's cells, without those that belong to a cell.
std::vector<std::size_t> bars_of(const std::string& line) {
  std::vector<std::size_t> bars;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '|' && (i == 0 || line[i - 1] != '\\')) bars.push_back(i);
  }
  return bars;
}

// The line below a table's head is made of ASCII: its bars stand where those of all lines are seen.
bool is_rule(const std::string& line) {
  return line.starts_with("|") && line.find_first_not_of("|:-") == std::string::npos;
}

std::string fitted_table(const std::vector<std::string>& lines, std::size_t columns,
                         const std::string& file) {
  const auto rule = std::ranges::find_if(lines, is_rule);
  if (rule == lines.end() || rule->size() <= columns) return fmt::format("{}\n", join(lines, "\n"));
  const std::vector<std::size_t> bars = bars_of(*rule);
  const auto fitting = std::ranges::count_if(bars, [&](std::size_t at) { return at < columns; });
  const auto kept = static_cast<std::size_t>(std::max<std::ptrdiff_t>(fitting, 2));
  std::string text;
  for (const std::string& line : lines) {
    const std::vector<std::size_t> own = bars_of(line);
    text += line.substr(0, own.size() > kept ? own[kept - 1] + 1 : line.size()) + "\n";
  }
  const auto left_out = static_cast<Index>(bars.size() - std::min(kept, bars.size()));
  return text + fmt::format("({} in {})\n", counted(left_out, "more column"), file);
}

}  // namespace

std::optional<TerminalSize> terminal_size(int descriptor) {
  winsize found = {};
  if (ioctl(descriptor, TIOCGWINSZ, &found) != 0 || found.ws_col < 1) return std::nullopt;
  return TerminalSize{found.ws_col, found.ws_row};
}

std::optional<int> terminal_columns() {
  const auto size = terminal_size(STDOUT_FILENO);
  return size ? std::optional(size->columns) : std::nullopt;
}

std::string fitted(const std::string& text, int columns) {
  if (width_of(text) <= columns) return text;
  const int room = std::max(0, columns - 3);
  std::size_t end = 0;
  for (int used = 0; end < text.size() && used + columns_of(text[end]) <= room; ++end) {
    used += columns_of(text[end]);
  }
  return text.substr(0, end) + std::string("...").substr(0, static_cast<std::size_t>(columns));
}

std::string wrapped(const std::string& text, int columns) {
  const std::string indent = text.substr(0, std::min(text.find_first_not_of(' '), text.size()));
  std::istringstream words(text);
  std::string lines, line;
  for (std::string word; words >> word;) {
    if (!line.empty() && width_of(line) + 1 + width_of(word) > columns) {
      lines += line + "\n";
      line.clear();
    }
    line += (line.empty() ? indent : " ") + word;
  }
  return lines + line;
}

std::string fitted_tables(const std::string& markdown, int columns, const std::string& file) {
  std::istringstream stream(markdown);
  std::string text;
  std::vector<std::string> table;
  const auto end_table = [&] {
    if (!table.empty()) text += fitted_table(table, static_cast<std::size_t>(columns), file);
    table.clear();
  };
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("|")) {
      table.push_back(line);
      continue;
    }
    end_table();
    text += (line.starts_with(" ") ? line : wrapped(line, columns)) + "\n";
  }
  end_table();
  return text;
}

}  // namespace npdr::pipeline
