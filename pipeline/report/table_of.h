/// A table as columns over rows: what a table of the report consists of.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "analysis/table.h"

namespace npdr::pipeline {

using analysis::Cell;
using analysis::Table;

/// A column: its title, and its cell in the row of an item.
template <class Item>
struct ColumnOf {
  std::string title;
  std::function<Cell(const Item&)> cell;
};

/// A row for each item (a run, a parameter, a method), and columns that are functions of items.
template <class Item>
struct TableOf {
  std::string caption;
  std::string row_header;
  std::vector<Item> rows;
  std::function<std::string(const Item&)> label;  ///< of a row
  std::vector<ColumnOf<Item>> columns = {};
  std::vector<std::string> first_notes = {};  ///< footnotes before those of the cells
  std::vector<std::string> last_notes = {};   ///< and after

  /// Adds a column.
  void add(std::string title, std::function<Cell(const Item&)> cell) {
    columns.push_back({std::move(title), std::move(cell)});
  }

  /// Adds a column for each of `titles`, with `cell`(title, item).
  template <class CellOf>
  void add_each(const std::vector<std::string>& titles, const CellOf& cell) {
    for (const std::string& title : titles) {
      add(title, [title, cell](const Item& item) { return Cell(cell(title, item)); });
    }
  }

  /// All cells, row by row, with their footnotes in that order.
  Table make() const {
    Table table{.name = "", .caption = caption, .row_header = row_header};
    for (const std::string& note : first_notes) table.add_footnote(note);
    for (const auto& column : columns) table.columns.push_back(column.title);
    for (const Item& item : rows) {
      analysis::Row& row = table.rows.emplace_back(analysis::Row{label(item), {}});
      for (const auto& column : columns) {
        for (const auto& note : row.cells.emplace_back(column.cell(item)).notes) {
          table.add_footnote(note);
        }
      }
    }
    for (const std::string& note : last_notes) table.add_footnote(note);
    return table;
  }
};

}  // namespace npdr::pipeline
