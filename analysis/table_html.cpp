#include <fmt/format.h>

#include "analysis/escape.h"
#include "analysis/table_text.h"
#include "analysis/table_writers.h"

namespace npdr::analysis {

namespace {

// Caption and what is below it: all of it, or the first line of what unfolds.
constexpr const char* kTable =
    "<figure class=\"table\" id=\"table-{}\">\n<figcaption>{}</figcaption>\n{}</figure>\n";
constexpr const char* kFoldedTable =
    "<figure class=\"table\" id=\"table-{}\">\n<details>\n<summary>{}</summary>\n{}</details>\n"
    "</figure>\n";

constexpr std::size_t kLongText = 24;  // [bytes] such cells may be broken into lines

std::string class_of(const Table& table, std::size_t column, const std::string& text) {
  if (flush_right(table, column)) return " class=\"number\"";
  return text.size() > kLongText ? " class=\"words\"" : "";
}

}  // namespace

std::string to_html(const Table& table) {
  table.check();
  const Markup markup = {escape_html, NumberStyle::plain, "<sup>{}</sup>", "<b>{}</b>"};
  const auto grid = text_grid(table, markup);
  // What is wider than a window must be reached by keys.
  std::string text = "<div class=\"scroll\" tabindex=\"0\"><table>\n";
  for (std::size_t r = 0; r < grid.size(); ++r) {
    if (r == 0) text += "<thead>\n";
    text += "<tr>";
    for (std::size_t c = 0; c < grid[r].size(); ++c) {
      const char* tag = r == 0 || c == 0 ? "th" : "td";
      const std::string kind = class_of(table, c, grid[r][c]);
      text += fmt::format("<{}{}>{}</{}>", tag, kind, grid[r][c], tag);
    }
    text += r == 0 ? "</tr>\n</thead>\n<tbody>\n" : "</tr>\n";
  }
  text += "</tbody>\n</table></div>\n";
  text += footnote_lines(table, markup, "<p class=\"note\">{}</p>\n");
  return fmt::format(fmt::runtime(table.is_folded ? kFoldedTable : kTable), table.name,
                     escape_html(table.caption), text);
}

}  // namespace npdr::analysis
