#include "analysis/table.h"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/file_stem.h"
#include "core/error.h"

namespace npdr::analysis {

std::size_t Table::footnote(const std::string& text) {
  const auto found = std::find(footnotes.begin(), footnotes.end(), text);
  const auto index = static_cast<std::size_t>(found - footnotes.begin());
  if (found == footnotes.end()) footnotes.push_back(text);
  return index;
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
      for (const std::size_t note : cell.notes) {
        if (note < footnotes.size()) continue;
        throw ShapeError(fmt::format("table '{}': row '{}' refers to footnote {} of {}", name,
                                     row.label, note, footnotes.size()));
      }
    }
  }
}

std::string column_title(const Column& column) {
  return column.published ? column.title + ", published" : column.title;
}

std::string footnote_mark(std::size_t index) {
  std::string mark(1, static_cast<char>('a' + index % 26));
  return index < 26 ? mark : footnote_mark(index / 26 - 1) + mark;
}

}  // namespace npdr::analysis
