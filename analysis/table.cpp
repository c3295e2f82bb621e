#include "analysis/table.h"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/file_stem.h"
#include "core/error.h"

namespace npdr::analysis {

void Table::add_footnote(const std::string& text) {
  if (std::ranges::find(footnotes, text) == footnotes.end()) footnotes.push_back(text);
}

bool Table::is_numeric(std::size_t column) const {
  return std::none_of(rows.begin(), rows.end(), [column](const Row& row) {
    return std::holds_alternative<std::string>(row.cells[column].value);
  });
}

void Table::check() const {
  check_file_stem("table", name);
  for (const Row& row : rows) {
    if (row.cells.size() != columns.size()) {
      throw ShapeError(fmt::format("table '{}': row '{}' has {} cells for {} columns", name,
                                   row.label, row.cells.size(), columns.size()));
    }
    for (const Cell& cell : row.cells) {
      for (const std::string& note : cell.notes) {
        if (std::ranges::find(footnotes, note) != footnotes.end()) continue;
        throw ShapeError(fmt::format("table '{}': row '{}' refers to '{}', which is no footnote",
                                     name, row.label, note));
      }
    }
  }
}

std::string footnote_mark(std::size_t index) {
  std::string mark(1, static_cast<char>('a' + index % 26));
  return index < 26 ? mark : footnote_mark(index / 26 - 1) + mark;
}

}  // namespace npdr::analysis
