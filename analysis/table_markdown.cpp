#include <algorithm>

#include "analysis/escape.h"
#include "analysis/table_text.h"
#include "analysis/table_writers.h"

namespace npdr::analysis {
namespace {

// Columns of a terminal: every code point takes one (no wide or combining characters expected).
std::size_t display_width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  }));
}

}  // namespace

std::string to_markdown(const Table& table) {
  table.check();
  const Markup markup = {escape_markdown, NumberStyle::plain, " ({})", "**{}**"};
  const auto grid = text_grid(table, markup);
  std::vector<std::size_t> widths(grid[0].size(), 3);
  for (const auto& row : grid) {
    for (std::size_t c = 0; c < row.size(); ++c)
      widths[c] = std::max(widths[c], display_width(row[c]));
  }
  std::string text;
  if (!table.caption.empty()) text += escape_markdown(table.caption) + "\n\n";
  for (std::size_t r = 0; r < grid.size(); ++r) {
    for (std::size_t c = 0; c < widths.size(); ++c) {
      const std::string padding(widths[c] - display_width(grid[r][c]), ' ');
      text += flush_right(table, c) ? "| " + padding + grid[r][c] + ' '
                                    : "| " + grid[r][c] + padding + ' ';
    }
    text += "|\n";
    if (r > 0) continue;
    for (std::size_t c = 0; c < widths.size(); ++c) {
      const std::string dashes(widths[c], '-');
      text += flush_right(table, c) ? "|-" + dashes + ':' : "|:" + dashes + '-';
    }
    text += "|\n";
  }
  text += footnote_lines(table, markup, "\n{}\n");
  if (!table.command.empty()) text += "\nMade by:\n\n" + prefixed_lines(table.command, "    ");
  return text;
}

}  // namespace npdr::analysis
