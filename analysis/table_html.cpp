#include <fmt/format.h>

#include "analysis/escape.h"
#include "analysis/table_text.h"
#include "analysis/table_writers.h"

namespace npdr::analysis {

std::string to_html(const Table& table) {
  table.check();
  const Markup markup = {escape_html, NumberStyle::plain, "<sup>{}</sup>"};
  const auto grid = text_grid(table, markup);
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
  text += footnote_lines(table, markup, "<p class=\"note\">{}</p>\n");
  return text + "</figure>\n";
}

}  // namespace npdr::analysis
