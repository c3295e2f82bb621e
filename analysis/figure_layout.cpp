#include "analysis/figure_layout.h"

#include <algorithm>
#include <sstream>

namespace npdr::analysis {
namespace {

// Sizes in pixels.
constexpr double kEdge = 14.0;     // around everything
constexpr double kTickGap = 10.0;  // between the labels of y ticks and what is beside them
constexpr double kBarGap = 12.0;
constexpr double kBarWidth = 14.0;
constexpr double kBarLabels = 58.0;

// Sizes in font sizes.
constexpr double kLegendHeight = 1.7;  // of an entry
constexpr double kTitleHeight = 2.2;
constexpr double kTickHeight = 2.6;
constexpr double kCharacter = 0.6;  // mean width

Box entry_box(const Figure& figure, const LegendEntry& entry, double left, double top) {
  const double words = text_width(entry.words, figure.sizes.font);
  return {left, top, kLegendMarkWidth + kLegendMarkGap + words, kLegendHeight * figure.sizes.font};
}

bool has_title(const Panel& panel) { return !panel.title.empty(); }

// Bytes at which characters begin, in UTF-8.
std::vector<std::size_t> character_starts(std::string_view words) {
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if ((static_cast<unsigned char>(words[i]) & 0xc0) != 0x80) starts.push_back(i);
  }
  return starts;
}

}  // namespace

FigureLayout::FigureLayout(const Figure& figure) {
  std::size_t x_lines = 0, y_lines = 0;
  double tick_width = 0.0;
  for (const Panel& panel : figure.panels) {
    x_lines =
        std::max(x_lines, title_lines(panel.x, figure.sizes.panel_width, figure.sizes.font).size());
    y_lines = std::max(y_lines,
                       title_lines(panel.y, figure.sizes.panel_height, figure.sizes.font).size());
    for (const std::string& label : panel.y.labels) {
      tick_width = std::max(tick_width, kTickGap + text_width(label, figure.sizes.tick_font));
    }
  }
  const double line = kLineHeight * figure.sizes.font;
  y_titles = kEdge + static_cast<double>(y_lines) * line;
  const double left = y_titles + tick_width, column = figure.sizes.panel_width + figure.sizes.gap;
  width = left + static_cast<double>(figure.columns) * column - figure.sizes.gap + kEdge;

  const bool has_corner = figure.panels[figure.columns - 1].series.empty();
  if (!has_corner) place_legend_above(figure, left);
  const auto second_row = figure.panels.begin() + static_cast<Index>(figure.columns);
  title_height = kTitleHeight * figure.sizes.tick_font;
  double top = legend.empty() ? kEdge : legend.back().bottom();
  top += std::any_of(figure.panels.begin(), second_row, has_title) ? title_height : 0.5 * kEdge;
  const double row = figure.sizes.panel_height + figure.sizes.gap +
                     (std::any_of(second_row, figure.panels.end(), has_title) ? title_height : 0.0);
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    panels.push_back({left + static_cast<double>(i % figure.columns) * column,
                      top + static_cast<double>(i / figure.columns) * row, figure.sizes.panel_width,
                      figure.sizes.panel_height});
  }
  height = panels.back().bottom() + kTickHeight * figure.sizes.tick_font +
           static_cast<double>(x_lines) * line + kEdge;

  if (has_corner) place_legend_in_corner(figure);
  if (figure.colors) {
    const Box& last = panels[figure.columns - 1];
    colors = {last.right() + kBarGap, last.top, kBarWidth, last.height};
    width = std::max(width, colors.right() + kBarLabels + kEdge);
  }
}

// Side by side, in as many lines as it takes.
void FigureLayout::place_legend_above(const Figure& figure, double left) {
  double x = left, y = 0.5 * kEdge;
  for (const LegendEntry& entry : figure.legend) {
    Box box = entry_box(figure, entry, x, y);
    if (x > left && box.right() > width - kEdge) {
      y += box.height;
      box = entry_box(figure, entry, left, y);
    }
    legend.push_back(box);
    width = std::max(width, box.right() + kEdge);
    x = box.right() + 2.0 * figure.sizes.font;
  }
}

// One below the other, flush right. Where that is too wide for what the rows beside it leave free,
// the figure grows.
void FigureLayout::place_legend_in_corner(const Figure& figure) {
  double bottom = kEdge, widest = 0.0;
  for (const LegendEntry& entry : figure.legend) {
    legend.push_back(entry_box(figure, entry, 0.0, bottom));
    bottom = legend.back().bottom();
    widest = std::max(widest, legend.back().width);
  }
  double left = width - kEdge - widest;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    if (figure.panels[i].series.empty() || panels[i].top >= bottom) continue;
    left = std::max(left, panels[i].right() + 2.0 * figure.sizes.gap);
  }
  for (Box& box : legend) box.left = left;
  width = std::max(width, left + widest + kEdge);
}

bool is_lowest(const Figure& figure, std::size_t i) {
  for (std::size_t k = i + figure.columns; k < figure.panels.size(); k += figure.columns) {
    if (!figure.panels[k].series.empty()) return false;
  }
  return true;
}

std::vector<std::string> title_lines(const Axis& axis, double max_width, double font_size) {
  std::vector<std::string> lines = wrap_text(axis.title, max_width, font_size);
  if (axis.unit.empty()) return lines;
  const bool fits =
      !lines.empty() && text_width(lines.back() + " " + axis.unit, font_size) <= max_width;
  if (!fits) lines.emplace_back();
  lines.back() += (fits ? " " : "") + axis.unit;
  return lines;
}

double text_width(std::string_view words, double font_size) {
  return kCharacter * font_size * static_cast<double>(character_starts(words).size());
}

std::vector<std::string> wrap_text(std::string_view words, double max_width, double font_size) {
  std::string blanks(words), word;
  std::ranges::replace(blanks, '_', ' ');
  std::istringstream stream(blanks);
  std::vector<std::string> lines;
  while (stream >> word) {
    if (!lines.empty() && text_width(lines.back() + " " + word, font_size) <= max_width) {
      lines.back() += " " + word;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

std::string elide_text(std::string_view words, double max_width, double font_size) {
  const std::vector<std::size_t> starts = character_starts(words);
  const auto most = static_cast<std::size_t>(max_width / (kCharacter * font_size));
  if (starts.size() <= most) return std::string(words);
  const std::size_t kept = most > 0 ? (most - 1) / 2 : 0;  // at either end
  const std::size_t tail = kept > 0 ? starts[starts.size() - kept] : words.size();
  return std::string(words.substr(0, starts[kept])) + "…" + std::string(words.substr(tail));
}

}  // namespace npdr::analysis
