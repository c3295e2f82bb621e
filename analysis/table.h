/// A results table: what it holds, apart from how it is written (analysis/table_writers.h).
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "analysis/summary.h"
#include "core/types.h"

namespace npdr::analysis {

/// A mean and standard deviation of n values. n = 0: not known (a published figure).
struct MeanStd {
  double mean = 0.0;
  double std = 0.0;  ///< NaN when there is none
  Index n = 0;
};

/// One cell: nothing, a text, a number, a count, or a mean with its spread; and the footnotes that
/// it refers to.
struct Cell {
  using Value = std::variant<std::monostate, std::string, double, Index, MeanStd>;

  Cell() = default;
  Cell(std::string text) : value(std::move(text)) {}
  Cell(const char* text) : value(std::string(text)) {}
  Cell(double number) : value(number) {}
  Cell(Index count) : value(count) {}
  Cell(const MeanStd& mean_std) : value(mean_std) {}
  Cell(const Summary& summary) : value(MeanStd{summary.mean, summary.std, summary.n}) {}

  Value value;
  std::vector<std::string> notes = {};  ///< texts, each of them one of Table::footnotes
};

struct Row {
  std::string label;
  std::vector<Cell> cells;  ///< one a column
  std::string symbol = {};  ///< formula that LaTeX shows in place of the label
  /// The best value, which the best number is nearest to: -infinity of an error, 0.9 of the
  /// coverage of 90 % bands. None: no number is better than another.
  std::optional<double> ideal = {};
};

struct Table {
  std::string name;  ///< of its files and label: letters, digits, '_' and '-'
  std::string caption;
  std::string row_header;                 ///< over the labels of the rows
  std::vector<std::string> columns = {};  ///< titles
  std::vector<Row> rows = {};
  std::vector<std::string> footnotes = {};
  std::string command = {};                ///< what made it; empty: not said
  bool is_folded = false;                  ///< on a page: shown when asked for
  std::vector<std::size_t> compared = {};  ///< columns whose numbers compete for the best of a row

  /// Adds a footnote, unless there is one with this text.
  void add_footnote(const std::string& text);

  /// True when no cell of the column is a text, so that it reads best flush right.
  bool is_numeric(std::size_t column) const;

  /// The best compared cells of a row, (columns): all cells that tie in the digits that are shown.
  /// None where fewer than two columns are compared; the writers but CSV show these cells bold.
  std::vector<bool> best_of(const Row& row) const;

  /// Throws ShapeError when a row has more or fewer cells than there are columns, a compared column
  /// isn't there, or a cell refers to a footnote that the table doesn't have; InputError for a name
  /// that can't be a file's.
  void check() const;
};

/// The mark of footnote 0, 1, ...: "a", ..., "z", "aa", "ab", ...
std::string footnote_mark(std::size_t index);

}  // namespace npdr::analysis
