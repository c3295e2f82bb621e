/// Model of the project's figures: what they show, apart from how it is drawn.
///
/// A figure is a grid of panels of one size, row by row, with a legend. A panel holds series, which
/// are drawn from tables of numbers in the order in which they stand, and marks in front of them.
/// Panels of a column share the ticks and title of their x axis, which stand at the lowest one;
/// panels of a row share those of their y axis, at the first. A panel without series leaves its
/// place empty. The legend stands above the panels, or in the top right corner where the grid
/// leaves that empty.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/axis.h"
#include "analysis/gnuplot.h"
#include "core/error.h"
#include "core/types.h"

namespace npdr::analysis {

/// Blue, orange and purple as in Figures A1 and A2, then three more, all told apart by readers with
/// any common kind of color vision (Okabe and Ito 2008). "#rrggbb".
inline constexpr const char* kMethodColors[] = {"#0072b2", "#e69f00", "#8e44ad",
                                                "#56b4e9", "#d55e00", "#009e73"};
inline constexpr std::size_t kMaxMethods = std::size(kMethodColors);
inline constexpr const char* kTruthColor = "#000000";
inline constexpr const char* kNominalColor = "#1b7837";
inline constexpr const char* kReferenceColors[] = {"#b2182b", "#8c510a", "#35978f"};
inline constexpr std::size_t kMaxReferences = std::size(kReferenceColors);

/// Numbers that series are drawn from, in the file <name of the figure>_<name>.dat.
struct DataTable {
  std::string name;
  std::string comment;  ///< what the columns hold
  RowMatrix values;     ///< (points, columns), SI; where a row isn't finite, a line is interrupted
};

/// Way to draw a series, and the columns that it needs.
enum class SeriesKind {
  line,      ///< x, y
  segments,  ///< x, y, dx, dy: a line of its own from each (x, y), with square ends
  dots,      ///< x, y
  steps,     ///< x, y: each y from its x to the next
  band,      ///< x, lower, upper
  area,      ///< x, y: from 0
  cells,     ///< x, y, value: a cell about each point, colored by the figure's scale
};

struct Series {
  SeriesKind kind = SeriesKind::line;
  std::string table;
  std::vector<Index> columns;  ///< of the table, from 0
  std::string color = {};      ///< "#rrggbb"
  double size = 1.6;           ///< [px] width of a line; of a dot in gnuplot's unit
  double opacity = 1.0;        ///< in [0, 1]
};

/// Looks of a mark, or of an entry of the legend: a filled shape; a line, in a panel from its
/// bottom to its top; or, only in legends, a line on a translucent band.
enum class LegendMark { dot, triangle, diamond, square, line, band };

enum class LineStyle { solid, dashed, dash_dotted };

/// A place in a panel that is pointed out; left out where it lies outside of the axes.
struct Mark {
  LegendMark shape = LegendMark::dot;
  std::string color;
  double x = 0.0;
  double y = 0.0;     ///< unused by lines
  double size = 1.0;  ///< in gnuplot's unit; unused by lines
  LineStyle style = LineStyle::solid;
};

/// One parameter vector that a figure marks, such as the nominal one.
struct MarkedPoint {
  std::string name;
  Vector place;  ///< (D) in the figure's coordinates; what lies outside isn't marked
  LegendMark mark = LegendMark::triangle;
  std::string color;
  LineStyle style = LineStyle::solid;  ///< of a line in its place
};

/// Words that a reader gets who points at a part of a panel.
struct Tip {
  Range x;
  Range y;
  std::string words;
};

struct Panel {
  std::string title = {};  ///< above it; its middle is left out where it is too long
  Axis x = {};
  Axis y = {};
  std::vector<Series> series = {};
  std::vector<Mark> marks = {};
  std::vector<Tip> tips = {};
};

struct LegendEntry {
  LegendMark mark = LegendMark::dot;
  std::string color;
  std::string words;
};

/// Scale of the values of cells, beside the first row.
struct ColorScale {
  std::string title;
  double low = 0.0;
  double high = 1.0;
};

/// Sizes in pixels.
struct FigureSizes {
  double panel_width = 230.0, panel_height = 230.0;
  double gap = 30.0;  ///< between panels
  double font = 11.0;
  double tick_font = 10.0;  ///< of ticks and the titles of panels
};

struct Figure {
  std::string name;         ///< of its files: letters, digits, '_' and '-'
  std::size_t columns = 1;  ///< at most as many as there are panels
  FigureSizes sizes = {};
  std::vector<LegendEntry> legend = {};
  std::optional<ColorScale> colors = {};
  std::vector<DataTable> tables = {};
  std::vector<Panel> panels = {};
};

/// Adds a table, named by its number, and returns that name.
std::string add_table(Figure& figure, const std::string& comment, const RowMatrix& values);

/// Color of a method: that of its entry in the legend, which gets a new one with this mark for a
/// method that it doesn't have yet. Throws InputError when there are more methods than colors.
std::string method_color(Figure& figure, const std::string& method, LegendMark mark);

/// Writes the data files, the script and what gnuplot makes of it into `directory`. Throws what
/// render_script() throws.
FigureFiles write_figure(const Figure& figure, const std::filesystem::path& directory);

/// Throws Problem with these words unless `good`.
template <class Problem = InputError, class... Args>
void require(bool good, fmt::format_string<const Args&...> words, const Args&... args) {
  if (!good) throw Problem(fmt::format(words, args...));
}

/// `wanted`, or the first `most` of `available` things where it is empty. Throws InputError that
/// says `what` they are ("pair plot 'x': parameter") unless these are `least` to `most`, each in
/// [0, available).
std::vector<Index> check_selection(const std::string& what, const std::vector<Index>& wanted,
                                   Index available, Index least, Index most);

}  // namespace npdr::analysis
