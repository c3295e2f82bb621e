#include "analysis/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "analysis/escape.h"
#include "core/error.h"

namespace npdr::analysis {
namespace {

// A filled circle as gnuplot 5 writes it, on a line of its own:
//   <use xlink:href='#gpPt6' transform='translate(X,Y) scale(R)' color='rgb(...)' opacity='0.55'/>
// The opacity is left out when it is 1.
struct Circle {
  std::string_view x, y, radius, color;
  std::string_view opacity = "1";
};

// Takes what stands before `end` off the front of `text`, and `end` with it.
std::optional<std::string_view> take_until(std::string_view& text, std::string_view end) {
  const auto position = text.find(end);
  if (position == std::string_view::npos) return std::nullopt;
  const auto taken = text.substr(0, position);
  text.remove_prefix(position + end.size());
  return taken;
}

std::optional<Circle> parse_circle(std::string_view line) {
  constexpr std::string_view begin = "\t<use xlink:href='#gpPt6' transform='translate(";
  if (!line.starts_with(begin)) return std::nullopt;
  line.remove_prefix(begin.size());
  const auto x = take_until(line, ",");
  const auto y = take_until(line, ") scale(");
  const auto radius = take_until(line, ")' color='");
  const auto color = take_until(line, "'");
  if (!x || !y || !radius || !color) return std::nullopt;
  Circle circle{*x, *y, *radius, *color};
  if (line == "/>") return circle;
  if (!take_until(line, "opacity='")) return std::nullopt;
  const auto opacity = take_until(line, "'/>");
  if (!opacity || !line.empty()) return std::nullopt;
  circle.opacity = *opacity;
  return circle;
}

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

}  // namespace

std::string tidy_svg(std::string_view svg) {
  std::string result;
  result.reserve(svg.size());
  std::string group;  // how the circles of the open group are painted; empty: none is open
  while (!svg.empty()) {
    const std::string_view line = svg.substr(0, svg.find('\n'));
    svg.remove_prefix(std::min(svg.size(), line.size() + 1));
    const auto circle = parse_circle(line);
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
