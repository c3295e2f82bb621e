#include <fmt/format.h>

#include "analysis/escape.h"
#include "analysis/table_text.h"
#include "analysis/table_writers.h"

namespace npdr::analysis {

std::string to_latex(const Table& table) {
  table.check();
  const Markup markup = {escape_latex, NumberStyle::latex, "\\textsuperscript{{{}}}"};
  const auto grid = text_grid(table, markup);
  std::string alignment;
  for (std::size_t c = 0; c < grid[0].size(); ++c) alignment += flush_right(table, c) ? 'r' : 'l';
  std::string text = "% Needs \\usepackage{booktabs}\n";
  if (!table.command.empty()) text += "% Made by:\n" + prefixed_lines(table.command, "%   ");
  text += "\\begin{table}\n  \\centering\n  \\caption{" + escape_latex(table.caption) +
          "}\n  \\label{tab:" + table.name + "}\n  \\begin{tabular}{" + alignment +
          "}\n    \\toprule\n";
  for (std::size_t r = 0; r < grid.size(); ++r) {
    text += fmt::format("    {} \\\\\n", fmt::join(grid[r], " & "));
    if (r == 0) text += "    \\midrule\n";
  }
  text += "    \\bottomrule\n  \\end{tabular}\n";
  text += footnote_lines(table, markup, "\n  {{\\footnotesize {}\\par}}\n");
  return text + "\\end{table}\n";
}

}  // namespace npdr::analysis
