/// Pieces that the formats of a table share: its cells as marked-up text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "analysis/number_text.h"
#include "analysis/table.h"

namespace npdr::analysis {

/// Marks with which a format writes what a table holds.
struct Markup {
  std::string (*escape)(std::string_view);
  NumberStyle numbers;
  std::string note;  ///< fmt pattern of a footnote mark
  std::string best;  ///< and of the best cells of a row
};

/// All cells as text: the titles, then the rows; the labels first.
std::vector<std::vector<std::string>> text_grid(const Table& table, const Markup& markup);

/// True when a column of text_grid() reads best flush right.
bool flush_right(const Table& table, std::size_t grid_column);

/// The footnotes, each begun with its mark, where cells refer to it, in the fmt pattern `line`.
std::string footnote_lines(const Table& table, const Markup& markup, const char* line);

/// Every line of a command that may have several, begun by `prefix`.
std::string prefixed_lines(std::string_view text, std::string_view prefix);

}  // namespace npdr::analysis
