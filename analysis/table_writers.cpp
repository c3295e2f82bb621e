#include "analysis/table_writers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "analysis/escape.h"
#include "analysis/number_text.h"
#include "core/atomic_file.h"
#include "core/file_error.h"

namespace npdr::analysis {
namespace {

// How one format writes what a table holds.
struct Format {
  std::string (*escape)(std::string_view);
  NumberStyle numbers;
  std::string note;  // fmt pattern of a footnote mark
};

// The mark of each footnote: a, b, ... of those that cells refer to; none of those that are about
// the table as a whole.
std::vector<std::string> footnote_marks(const Table& table) {
  std::vector<std::string> marks(table.footnotes.size());
  std::set<std::size_t> referred;
  for (const Row& row : table.rows) {
    for (const Cell& cell : row.cells) referred.insert(cell.notes.begin(), cell.notes.end());
  }
  std::size_t count = 0;
  for (const std::size_t note : referred) marks[note] = footnote_mark(count++);
  return marks;
}

std::string cell_text(const Cell& cell, const Format& format,
                      const std::vector<std::string>& marks) {
  std::string text;
  if (const auto* words = std::get_if<std::string>(&cell.value)) {
    text = format.escape(*words);
  } else if (const auto* number = std::get_if<double>(&cell.value)) {
    text = number_text(*number, format.numbers);
  } else if (const auto* count = std::get_if<Index>(&cell.value)) {
    text = std::to_string(*count);
  } else if (const auto* mean_std = std::get_if<MeanStd>(&cell.value)) {
    text = mean_std_text(mean_std->mean, mean_std->std, format.numbers);
  }
  for (const std::size_t note : cell.notes) {
    text += fmt::format(fmt::runtime(format.note), marks[note]);
  }
  return text;
}

// The footnotes, each begun by `note` with its mark and a blank, where it has one, in `line`.
std::string footnote_lines(const Table& table, const Format& format, const char* line) {
  const std::vector<std::string> marks = footnote_marks(table);
  std::string text;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    std::string words = format.escape(table.footnotes[i]);
    if (!marks[i].empty()) {
      const std::string mark = fmt::format(fmt::runtime(format.note), marks[i]);
      words = mark.substr(mark.find_first_not_of(' ')) + ' ' + words;
    }
    text += fmt::format(fmt::runtime(line), words);
  }
  return text;
}

// Every line of a command that may have several, begun by `prefix`.
std::string prefixed_lines(std::string_view text, std::string_view prefix) {
  std::string result(prefix);
  for (const char c : text) {
    result += c;
    if (c == '\n') result += prefix;
  }
  return result + '\n';
}

using Grid = std::vector<std::vector<std::string>>;

// All cells of the table as text: the titles, then the rows; the labels first.
Grid text_grid(const Table& table, const Format& format) {
  Grid grid(1, {format.escape(table.row_header)});
  for (const Column& column : table.columns) grid[0].push_back(format.escape(column_title(column)));
  const std::vector<std::string> marks = footnote_marks(table);
  for (const Row& row : table.rows) {
    grid.push_back({format.escape(row.label)});
    for (const Cell& cell : row.cells) grid.back().push_back(cell_text(cell, format, marks));
  }
  return grid;
}

// Columns of a terminal: every code point takes one (no wide or combining characters expected).
std::size_t display_width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  }));
}

// Column 0 holds the labels.
bool flush_right(const Table& table, std::size_t grid_column) {
  return grid_column > 0 && table.is_numeric(grid_column - 1);
}

std::string number_csv(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

bool has_means(const Table& table, std::size_t column) {
  return std::any_of(table.rows.begin(), table.rows.end(), [column](const Row& row) {
    return std::holds_alternative<MeanStd>(row.cells[column].value);
  });
}

std::string cell_csv(const Cell& cell, bool three_columns) {
  if (const auto* mean_std = std::get_if<MeanStd>(&cell.value)) {
    return fmt::format(",{},{},{}", number_csv(mean_std->mean), number_csv(mean_std->std),
                       mean_std->n > 0 ? std::to_string(mean_std->n) : "");
  }
  std::string text = ",";
  if (const auto* words = std::get_if<std::string>(&cell.value)) text += quote_csv(*words);
  if (const auto* number = std::get_if<double>(&cell.value)) text += number_csv(*number);
  if (const auto* count = std::get_if<Index>(&cell.value)) text += std::to_string(*count);
  return three_columns ? text + ",," : text;
}

}  // namespace

std::string to_markdown(const Table& table) {
  table.check();
  const Format format = {escape_markdown, NumberStyle::plain, " ({})"};
  const Grid grid = text_grid(table, format);
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
  text += footnote_lines(table, format, "\n{}\n");
  if (!table.command.empty()) text += "\nMade by:\n\n" + prefixed_lines(table.command, "    ");
  return text;
}

std::string to_csv(const Table& table) {
  table.check();
  std::string text = quote_csv(table.row_header);
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const std::string title = column_title(table.columns[c]);
    if (has_means(table, c)) {
      for (const char* part : {" mean", " std", " n"}) text += ',' + quote_csv(title + part);
    } else {
      text += ',' + quote_csv(title);
    }
  }
  text += '\n';
  for (const Row& row : table.rows) {
    text += quote_csv(row.label);
    for (std::size_t c = 0; c < row.cells.size(); ++c) {
      text += cell_csv(row.cells[c], has_means(table, c));
    }
    text += '\n';
  }
  return text;
}

std::string to_latex(const Table& table) {
  table.check();
  const Format format = {escape_latex, NumberStyle::latex, "\\textsuperscript{{{}}}"};
  const Grid grid = text_grid(table, format);
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
  text += footnote_lines(table, format, "\n  {{\\footnotesize {}\\par}}\n");
  return text + "\\end{table}\n";
}

std::string to_html(const Table& table) {
  table.check();
  const Format format = {escape_html, NumberStyle::plain, "<sup>{}</sup>"};
  const Grid grid = text_grid(table, format);
  std::string text = "<figure class=\"table\" id=\"table-" + table.name + "\">\n<figcaption>" +
                     escape_html(table.caption) + "</figcaption>\n<div class=\"scroll\"><table>\n";
  for (std::size_t r = 0; r < grid.size(); ++r) {
    if (r == 0) text += "<thead>\n";
    text += "<tr>";
    for (std::size_t c = 0; c < grid[r].size(); ++c) {
      const char* tag = r == 0 || c == 0 ? "th" : "td";
      const char* side = flush_right(table, c) ? " class=\"number\"" : "";
      text += fmt::format("<{}{}>{}</{}>", tag, side, grid[r][c], tag);
    }
    text += r == 0 ? "</tr>\n</thead>\n<tbody>\n" : "</tr>\n";
  }
  text += "</tbody>\n</table></div>\n";
  text += footnote_lines(table, format, "<p class=\"note\">{}</p>\n");
  if (!table.command.empty()) {
    text += "<pre class=\"command\"><code>" + escape_html(table.command) + "</code></pre>\n";
  }
  return text + "</figure>\n";
}

void write_table(const Table& table, const std::filesystem::path& directory) {
  write_text_file(directory / (table.name + ".md"), to_markdown(table));
  write_text_file(directory / (table.name + ".csv"), to_csv(table));
  write_text_file(directory / (table.name + ".tex"), to_latex(table));
}

void remove_table(std::string_view name, const std::filesystem::path& directory) {
  for (const char* extension : {".md", ".csv", ".tex"}) {
    const std::filesystem::path path = directory / (std::string(name) + extension);
    std::error_code error;
    std::filesystem::remove(path, error);
    if (error) throw_file_error(path, "be removed", error.value());
  }
}

}  // namespace npdr::analysis
