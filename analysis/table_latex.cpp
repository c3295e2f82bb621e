#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "analysis/escape.h"
#include "analysis/table_text.h"
#include "analysis/table_writers.h"

namespace npdr::analysis {
namespace {

constexpr std::string_view kPlusMinus = " \\pm ";
// Shrinks what is wider than the column or page that it stands in, and nothing else.
constexpr const char* kFitted =
    "  \\resizebox{\\ifdim\\width>\\linewidth\\linewidth\\else\\width\\fi}{!}{%\n";

using Grid = std::vector<std::vector<std::string>>;

// A mean with its spread, "$0.26 \pm 0.01$": where all of a column are, their signs are aligned.
bool is_split(const std::string& cell) {
  return cell.empty() ||
         (cell.find(kPlusMinus) != std::string::npos && cell.find("$[") == std::string::npos);
}

std::vector<bool> split_columns(const Grid& grid) {
  std::vector<bool> split;
  for (std::size_t c = 0; c < grid[0].size(); ++c) {
    const auto is_split_here = [c](const auto& row) { return is_split(row[c]); };
    const auto is_empty = [c](const auto& row) { return row[c].empty(); };
    split.push_back(c > 0 && std::all_of(grid.begin() + 1, grid.end(), is_split_here) &&
                    !std::all_of(grid.begin() + 1, grid.end(), is_empty));
  }
  return split;
}

std::string halves(const std::string& cell) {
  const std::size_t sign = cell.find(kPlusMinus);
  if (sign == std::string::npos) return " & ";
  const std::string bold = cell.substr(0, cell.find('$'));  // or nothing
  return cell.substr(0, sign) + "$ & " + bold + "${}" + cell.substr(sign + 1);
}

std::string row_text(const std::vector<std::string>& cells, const std::vector<bool>& split,
                     bool is_header) {
  std::vector<std::string> parts;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    parts.push_back(!split[c]   ? cells[c]
                    : is_header ? "\\multicolumn{2}{c}{" + cells[c] + "}"
                                : halves(cells[c]));
  }
  return fmt::format("    {} \\\\\n", fmt::join(parts, " & "));
}

}  // namespace

std::string to_latex(const Table& table) {
  table.check();
  const Markup markup = {escape_latex, NumberStyle::latex, "\\textsuperscript{{{}}}",
                         "\\boldmath{}"};
  Grid grid = text_grid(table, markup);
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const std::string& symbol = table.rows[r].symbol;
    if (!symbol.empty()) grid[r + 1][0] = "$" + symbol + "$";
  }
  const std::vector<bool> split = split_columns(grid);
  std::string alignment;
  for (std::size_t c = 0; c < grid[0].size(); ++c) {
    alignment += split[c] ? "r@{}l" : flush_right(table, c) ? "r" : "l";
  }
  std::string text = "% Needs \\usepackage{booktabs,graphicx}; table* for both columns of a page\n";
  if (!table.command.empty()) text += "% Made by:\n" + prefixed_lines(table.command, "%   ");
  text += "\\begin{table}\n  \\centering\n  \\caption{" + escape_latex(table.caption) +
          "}\n  \\label{tab:" + table.name + "}\n" + kFitted + "  \\begin{tabular}{" + alignment +
          "}\n    \\toprule\n";
  for (std::size_t r = 0; r < grid.size(); ++r) {
    text += row_text(grid[r], split, r == 0);
    if (r == 0) text += "    \\midrule\n";
  }
  text += "    \\bottomrule\n  \\end{tabular}}\n";
  text += footnote_lines(table, markup, "\n  {{\\footnotesize {}\\par}}\n");
  return text + "\\end{table}\n";
}

}  // namespace npdr::analysis
