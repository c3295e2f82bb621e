/// Places of a figure's parts, in pixels.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/figure.h"

namespace npdr::analysis {

/// A rectangle in pixels from the figure's top left corner.
struct Box {
  double left = 0.0;
  double top = 0.0;
  double width = 0.0;
  double height = 0.0;

  double right() const { return left + width; }
  double bottom() const { return top + height; }
  double center() const { return left + 0.5 * width; }
  double middle() const { return top + 0.5 * height; }
};

inline constexpr double kLineHeight = 1.25;       ///< of a text, in font sizes
inline constexpr double kLegendMarkWidth = 22.0;  ///< [px]
inline constexpr double kLegendMarkGap = 6.0;     ///< [px] between a mark and its words

/// Leaves as much room around the panels as titles, labels and the legend need.
struct FigureLayout {
  explicit FigureLayout(const Figure& figure);

  double width = 0.0;
  double height = 0.0;
  double y_titles = 0.0;      ///< where the titles of y axes end at the right
  double title_height = 0.0;  ///< of the titles of panels
  std::vector<Box> panels;    ///< of the figure, in their order
  std::vector<Box> legend;    ///< of its entries
  Box colors;                 ///< of the bar, without its labels

 private:
  void place_legend_above(const Figure& figure, double left);
  void place_legend_in_corner(const Figure& figure);
};

/// True when no panel is drawn below panel i, so that it shows what its column shares.
bool is_lowest(const Figure& figure, std::size_t i);

/// Lines of an axis' title: the words, then the unit, in a line of its own where it doesn't fit.
std::vector<std::string> title_lines(const Axis& axis, double max_width, double font_size);

/// Width that a text takes in the figures' font of `font_size` px, about.
double text_width(std::string_view words, double font_size);

/// `words`, broken at blanks and underscores into lines of at most `max_width` px where
/// possible; underscores become blanks.
std::vector<std::string> wrap_text(std::string_view words, double max_width, double font_size);

/// `words`, with its middle left out ("begin…end") where it is wider than `max_width` px.
std::string elide_text(std::string_view words, double max_width, double font_size);

}  // namespace npdr::analysis
