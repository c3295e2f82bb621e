#include "analysis/figure_overlay.h"

#include <algorithm>

#include "analysis/escape.h"

namespace npdr::analysis {
namespace {

std::string axis_attributes(char name, const Axis& axis) {
  const std::string title = axis.title + (axis.unit.empty() ? "" : " " + axis.unit);
  return fmt::format(
      " data-{0}-lower=\"{1:.9g}\" data-{0}-upper=\"{2:.9g}\" data-{0}-title=\"{3}\"", name,
      axis.lower * axis.scale, axis.upper * axis.scale, escape_html(title));
}

std::string place(const Box& box) {
  return fmt::format("x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"", box.left,
                     box.top, box.width, box.height);
}

// A part of a panel's box.
Box place_of(const Tip& tip, const Panel& panel, const Box& box) {
  const auto share = [](const Axis& axis, double value) {
    return std::clamp((value - axis.lower) / (axis.upper - axis.lower), 0.0, 1.0);
  };
  const double left = share(panel.x, tip.x.lower), right = share(panel.x, tip.x.upper);
  const double bottom = share(panel.y, tip.y.lower), top = share(panel.y, tip.y.upper);
  return {box.left + left * box.width, box.top + (1.0 - top) * box.height,
          (right - left) * box.width, (top - bottom) * box.height};
}

std::string panel_shapes(const Panel& panel, const Box& box) {
  std::string shapes = fmt::format("<rect class=\"panel\" {}{}{}/>\n", place(box),
                                   axis_attributes('x', panel.x), axis_attributes('y', panel.y));
  for (const Tip& tip : panel.tips) {
    shapes += fmt::format("<rect class=\"tip\" {}><title>{}</title></rect>\n",
                          place(place_of(tip, panel, box)), escape_html(tip.words));
  }
  return shapes;
}

}  // namespace

std::string overlay_of(const Figure& figure, const FigureLayout& layout) {
  std::string group =
      "<g class=\"overlay\" fill=\"none\" stroke=\"none\" pointer-events=\"all\">\n";
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    if (figure.panels[i].series.empty()) continue;
    group += panel_shapes(figure.panels[i], layout.panels[i]);
  }
  for (const LegendEntry& entry : figure.legend) {
    group += fmt::format("<g class=\"entry\" data-color=\"{}\" data-name=\"{}\"/>\n", entry.color,
                         escape_html(entry.words));
  }
  return group + "</g>\n";
}

}  // namespace npdr::analysis
