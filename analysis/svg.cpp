#include "analysis/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "analysis/escape.h"
#include "core/error.h"

namespace npdr::analysis {
namespace {

// "<title>...</title>" and "<desc>...</desc>" with what they hold.
void remove_elements(std::string& text, std::string_view name) {
  const std::string begin = fmt::format("<{}>", name);
  const std::string end = fmt::format("</{}>", name);
  std::size_t from = 0;
  while ((from = text.find(begin, from)) != std::string::npos) {
    const std::size_t to = text.find(end, from);
    if (to == std::string::npos) return;
    text.erase(from, to + end.size() - from);
  }
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

// Takes `before` and what stands behind it up to `end`, both included, from the beginning of
// `text`; what stands between them, empty: it isn't there.
std::string_view take(std::string_view& text, std::string_view before, char end) {
  if (!text.starts_with(before)) return {};
  const std::size_t size = text.substr(before.size()).find(end);
  if (size == 0 || size == std::string_view::npos) return {};
  const std::string_view found = text.substr(before.size(), size);
  text.remove_prefix(before.size() + size + 1);
  return found;
}

struct Circle {
  std::string_view x, y, radius, color, opacity = "1";
};

// A filled circle as gnuplot 5 writes it, on a line of its own. An opacity of 1 is left out.
std::optional<Circle> circle_of(std::string_view line) {
  Circle circle;
  circle.x = take(line, "\t<use xlink:href='#gpPt6' transform='translate(", ',');
  circle.y = take(line, "", ')');
  circle.radius = take(line, " scale(", ')');
  circle.color = take(line, "' color='", '\'');
  const std::string_view opacity = take(line, " opacity='", '\'');
  if (!opacity.empty()) circle.opacity = opacity;
  const bool is_whole = !circle.x.empty() && !circle.y.empty() && !circle.radius.empty() &&
                        !circle.color.empty() && line == "/>";
  return is_whole ? std::optional(circle) : std::nullopt;
}

}  // namespace

std::string tidy_svg(std::string_view svg) {
  std::string result;
  result.reserve(svg.size());
  std::string group;  // how the circles of the open group are painted; empty: none is open
  while (!svg.empty()) {
    const std::string_view line = svg.substr(0, svg.find('\n'));
    svg.remove_prefix(std::min(svg.size(), line.size() + 1));
    const std::optional<Circle> circle = circle_of(line);
    const std::string wanted = circle
                                   ? fmt::format("<g fill='{}' fill-opacity='{}' stroke='none'>\n",
                                                 circle->color, circle->opacity)
                                   : "";
    if (wanted != group) {
      if (!group.empty()) result += "</g>\n";
      result += wanted;
      group = wanted;
    }
    if (circle) {
      result +=
          fmt::format("<circle cx='{}' cy='{}' r='{}'/>\n", circle->x, circle->y, circle->radius);
    } else {
      result.append(line) += '\n';
    }
  }
  if (!group.empty()) result += "</g>\n";
  remove_elements(result, "title");
  remove_elements(result, "desc");
  // XML allows it at the end of a section of raw text only, of which gnuplot writes none here.
  replace_all(result, "]]>", "]]&gt;");
  return result;
}

std::string inline_svg(std::string_view svg, std::string_view prefix, std::string_view label) {
  const auto begin = svg.find("<svg");
  if (begin == std::string_view::npos) throw InputError("not an SVG: no <svg> element");
  std::string text(svg.substr(begin));
  text.insert(4, fmt::format(" role=\"img\" aria-label=\"{}\"", escape_html(label)));
  for (const char* quote : {"'", "\""}) {
    for (const char* attribute : {" id=", "href="}) {
      const std::string hash = attribute[0] == 'h' ? "#" : "";
      const std::string before = attribute + std::string(quote) + hash;
      replace_all(text, before, before + std::string(prefix));
    }
  }
  replace_all(text, "url(#", "url(#" + std::string(prefix));
  return text;
}

}  // namespace npdr::analysis
