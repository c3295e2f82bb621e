#include "analysis/table_text.h"

#include <fmt/format.h>

#include <map>
#include <set>

#include "core/printable.h"

namespace npdr::analysis {
namespace {

using Marks = std::map<std::string, std::string>;  // of footnotes, by their texts

// a, b, ... of those that cells refer to; none of those that are about the table as a whole.
Marks footnote_marks(const Table& table) {
  std::set<std::string> referred;
  for (const Row& row : table.rows) {
    for (const Cell& cell : row.cells) referred.insert(cell.notes.begin(), cell.notes.end());
  }
  Marks marks;
  for (const std::string& note : table.footnotes) {
    if (referred.contains(note)) marks.emplace(note, footnote_mark(marks.size()));
  }
  return marks;
}

std::string value_text(const Cell& cell, const Markup& markup) {
  if (const auto* words = std::get_if<std::string>(&cell.value)) return markup.escape(*words);
  if (const auto* number = std::get_if<double>(&cell.value)) {
    return number_text(*number, markup.numbers);
  }
  if (const auto* count = std::get_if<Index>(&cell.value)) return std::to_string(*count);
  if (const auto* mean_std = std::get_if<MeanStd>(&cell.value)) {
    return mean_std_text(mean_std->mean, mean_std->std, markup.numbers);
  }
  return "";
}

}  // namespace

std::vector<std::vector<std::string>> text_grid(const Table& table, const Markup& markup) {
  std::vector<std::vector<std::string>> grid(1, {markup.escape(table.row_header)});
  for (const std::string& title : table.columns) grid[0].push_back(markup.escape(title));
  const Marks marks = footnote_marks(table);
  for (const Row& row : table.rows) {
    grid.push_back({markup.escape(row.label)});
    const std::vector<bool> best = table.best_of(row);
    for (std::size_t c = 0; c < row.cells.size(); ++c) {
      std::string text = value_text(row.cells[c], markup);
      if (best[c]) text = fmt::format(fmt::runtime(markup.best), text);
      for (const std::string& note : row.cells[c].notes) {
        text += fmt::format(fmt::runtime(markup.note), marks.at(note));
      }
      grid.back().push_back(std::move(text));
    }
  }
  return grid;
}

bool flush_right(const Table& table, std::size_t grid_column) {
  return grid_column > 0 && table.is_numeric(grid_column - 1);
}

std::string footnote_lines(const Table& table, const Markup& markup, const char* line) {
  const Marks marks = footnote_marks(table);
  std::string text;
  for (const std::string& note : table.footnotes) {
    std::string words = markup.escape(note);
    if (marks.contains(note)) {
      const std::string mark = fmt::format(fmt::runtime(markup.note), marks.at(note));
      words = mark.substr(mark.find_first_not_of(' ')) + ' ' + words;
    }
    text += fmt::format(fmt::runtime(line), words);
  }
  return text;
}

std::string prefixed_lines(std::string_view text, std::string_view prefix) {
  std::string result(prefix);
  for (const char c : printable(text)) {
    result += c;
    if (c == '\n') result += prefix;
  }
  return result + '\n';
}

}  // namespace npdr::analysis
