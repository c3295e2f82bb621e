/// What the project's figures have in common: colours, and panels and legends placed by pixels.
#pragma once

#include <cstddef>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace npdr::analysis {

/// Blue, orange and purple as in Figures A1 and A2, then three more, all told apart by readers with
/// any common kind of colour vision (Okabe and Ito 2008). "#rrggbb".
inline constexpr const char* kMethodColors[] = {"#0072b2", "#e69f00", "#8e44ad",
                                                "#56b4e9", "#d55e00", "#009e73"};
inline constexpr std::size_t kMaxMethods = std::size(kMethodColors);
inline constexpr const char* kTruthColor = "#000000";
inline constexpr const char* kNominalColor = "#1b7837";
inline constexpr const char* kReferenceColors[] = {"#b2182b", "#8c510a", "#35978f"};
inline constexpr std::size_t kMaxReferences = std::size(kReferenceColors);

/// "#rrggbb" with an opacity in [0, 1], as gnuplot's "'#aarrggbb'" (where aa is the transparency).
std::string translucent(std::string_view color, double opacity);

/// A rectangle of a figure in pixels from its top left corner.
struct Panel {
  double left = 0.0;
  double top = 0.0;
  double width = 0.0;
  double height = 0.0;
};

/// Places things on a figure of this size; gnuplot measures in shares of it from the bottom left.
class PlotLayout {
 public:
  PlotLayout(double width, double height) : width_(width), height_(height) {}

  /// "screen 0.1, screen 0.9".
  std::string at(double x, double y) const;

  /// The margin commands that make the next plot fill `panel`.
  std::string margins(const Panel& panel) const;

  /// A text anchored at (x, y) with gnuplot's `options` ("center rotate by 90 ...").
  std::string text(double x, double y, std::string_view words, std::string_view options) const;

 private:
  double width_;
  double height_;
};

/// How an entry of a legend looks.
enum class LegendMark {
  dot,       ///< filled circle
  triangle,  ///< filled triangle
  diamond,   ///< filled diamond
  square,    ///< filled square
  line,      ///< a line
  band,      ///< a line on a translucent band
};

struct LegendEntry {
  LegendMark mark = LegendMark::dot;
  std::string color;
  std::string words;
};

/// A filled mark with a white rim at `position` (gnuplot's coordinates), in front of the plot.
std::string mark_command(LegendMark mark, const std::string& position, double size,
                         std::string_view color);

/// Width that a text takes in the figures' font of `font_size` px, about.
double text_width(std::string_view words, double font_size);

/// Width of an entry: mark, gap and words.
double legend_entry_width(const LegendEntry& entry, double font_size);

/// Commands for one entry whose mark is centred on the height y and begins at x.
std::string legend_commands(const PlotLayout& layout, const LegendEntry& entry, double x, double y,
                            double font_size);

/// `words`, broken at blanks and underscores into lines of at most `max_width` px where
/// possible; underscores become blanks.
std::vector<std::string> wrap_text(std::string_view words, double max_width, double font_size);

/// `words`, with its middle left out ("begin…end") where it is wider than `max_width` px.
std::string elide_text(std::string_view words, double max_width, double font_size);

}  // namespace npdr::analysis
