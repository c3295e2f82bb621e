// Axes, and where a figure has its parts.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "analysis/axis.h"
#include "analysis/figure_layout.h"
#include "core/constants.h"
#include "core/error.h"

namespace npdr::analysis {
namespace {

using Lines = std::vector<std::string>;

Figure grid_of(std::size_t rows, std::size_t columns) {
  Figure figure{.name = "grid", .columns = columns};
  figure.panels.resize(rows * columns);
  for (Panel& panel : figure.panels) panel.series.resize(1);
  return figure;
}

// Only the lower triangle is drawn.
Figure triangle_of(std::size_t size) {
  Figure figure = grid_of(size, size);
  for (std::size_t i = 0; i < size * size; ++i) {
    if (i % size > i / size) figure.panels[i].series.clear();
  }
  return figure;
}

bool overlap(const Box& a, const Box& b) {
  return a.left < b.right() && b.left < a.right() && a.top < b.bottom() && b.top < a.bottom();
}

// Panels and entries of the legend lie inside of the figure and not on each other.
void expect_apart(const Figure& figure) {
  const FigureLayout layout(figure);
  std::vector<Box> boxes = layout.legend;
  ASSERT_EQ(boxes.size(), figure.legend.size());
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    if (!figure.panels[i].series.empty()) boxes.push_back(layout.panels[i]);
  }
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    EXPECT_GE(boxes[i].left, 0.0);
    EXPECT_GE(boxes[i].top, 0.0);
    EXPECT_LE(boxes[i].right(), layout.width);
    EXPECT_LE(boxes[i].bottom(), layout.height);
    for (std::size_t k = 0; k < i; ++k) EXPECT_FALSE(overlap(boxes[i], boxes[k])) << i << " " << k;
  }
}

TEST(FigureLayout, LeavesRoomForTheLegend) {
  for (const std::size_t num_entries : {0u, 1u, 6u}) {
    for (const std::size_t length : {3u, 40u, 200u}) {
      for (Figure figure : {grid_of(1, 1), grid_of(2, 3), triangle_of(2), triangle_of(7)}) {
        figure.legend.assign(num_entries, {LegendMark::line, "#123456", std::string(length, 'x')});
        expect_apart(figure);
      }
    }
  }
}

TEST(FigureLayout, LeavesRoomForTitlesAndLabels) {
  Figure figure = grid_of(2, 2);
  const FigureLayout bare(figure);
  figure.panels[0].y.labels = {"0.123456"};
  figure.panels[3].x.title = "x";
  const FigureLayout labeled(figure);
  EXPECT_GT(labeled.panels[0].left, bare.panels[0].left + text_width("0.123456", 10.0));
  EXPECT_GT(labeled.height - labeled.panels[3].bottom(), bare.height - bare.panels[3].bottom());
  EXPECT_EQ(labeled.panels[2].top, bare.panels[2].top);
  figure.panels[2].title = "title";
  EXPECT_GT(FigureLayout(figure).panels[2].top, bare.panels[2].top);
}

TEST(FigureLayout, PutsTheColorsBesideTheFirstRow) {
  Figure figure = grid_of(2, 2);
  figure.colors = ColorScale{};
  const FigureLayout layout(figure);
  EXPECT_GT(layout.colors.left, layout.panels[1].right());
  EXPECT_EQ(layout.colors.top, layout.panels[1].top);
  EXPECT_EQ(layout.colors.bottom(), layout.panels[1].bottom());
  EXPECT_LT(layout.colors.right(), layout.width);
}

TEST(FigureLayout, TheLowestPanelHasNoOtherBelow) {
  Figure figure = grid_of(2, 2);
  EXPECT_FALSE(is_lowest(figure, 0));
  EXPECT_TRUE(is_lowest(figure, 2));
  figure.panels[2].series.clear();
  EXPECT_TRUE(is_lowest(figure, 0));
}

TEST(FigureLayout, UnitsFollowTheTitleWhereTheyFit) {
  const Axis axis{.title = "pole_mass", .unit = "[10⁻³ kg]"};
  EXPECT_EQ(title_lines(axis, 1000.0, 10.0), (Lines{"pole mass [10⁻³ kg]"}));
  EXPECT_EQ(title_lines(axis, 60.0, 10.0), (Lines{"pole mass", "[10⁻³ kg]"}));
  EXPECT_EQ(title_lines({.title = "gain"}, 60.0, 10.0), (Lines{"gain"}));
  EXPECT_EQ(title_lines({}, 60.0, 10.0), Lines{});
  EXPECT_EQ(text_width("10⁻³", 10.0), text_width("1000", 10.0)) << "not of bytes";
}

using Labels = std::vector<std::string>;

TEST(Axis, ScalesByAPowerOfTenWhereLabelsWouldBeLong) {
  const Axis damping = make_axis({0.0, 1e-3}, "", "N m s/rad");
  EXPECT_DOUBLE_EQ(damping.scale, 1e3);
  EXPECT_EQ(damping.unit, "[10⁻³ N m s/rad]");
  EXPECT_EQ(damping.labels, (Labels{"0.4", "0.8"}));
  const Axis mass = make_axis({0.066, 0.12}, "", "kg");
  EXPECT_EQ(mass.scale, 1.0);
  EXPECT_EQ(mass.unit, "[kg]");
  EXPECT_EQ(mass.labels, (Labels{"0.08", "0.10"}));
  EXPECT_EQ(make_axis({0.0, 2.5e12}, "", "1").unit, "[10¹²]");
  EXPECT_EQ(make_axis({0.0, 1.0}, "", "1").unit, "");
  EXPECT_EQ(make_axis({0.0, 1.0}, "", "").unit, "");
}

TEST(Axis, KeepsTicksOffTheEndsUnlessTheyMayBeThere) {
  EXPECT_EQ(make_axis({-0.08, 0.08}, "", "m").labels, (Labels{"-5", "0", "5"}));
  EXPECT_EQ(make_axis({0.0, 5.0}, "", "s", 3).labels, (Labels{"1", "2", "3", "4"}));
  EXPECT_EQ(make_axis({0.0, 1.0}, "", "", 3, 0.0).labels, (Labels{"0.0", "0.5", "1.0"}));
}

TEST(Axis, HasEnoughTicksInsideAnyRange) {
  for (const double lower : {-3.2, 0.0, 1e-7, 41.0, 1e5}) {
    for (const double range : {1e-7, 0.003, 0.7, 1.0, 9.9, 1e6}) {
      const Axis axis = make_axis({lower, lower + range}, "", "m");
      ASSERT_GE(axis.ticks.size(), 2u) << lower << " " << range;
      EXPECT_LE(axis.ticks.size(), 9u) << lower << " " << range;
      EXPECT_GT(axis.ticks.front(), lower * axis.scale);
      EXPECT_LT(axis.ticks.back(), (lower + range) * axis.scale);
      EXPECT_EQ(axis.labels.size(), axis.ticks.size());
    }
  }
}

TEST(Axis, ComesToAnEndWhereDoublesHardlyTellItsEndsApart) {
  constexpr double tiny = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(make_axis({0.0, 1e-310}, "", "kg").unit, "[10⁻³⁰⁰ kg]");
  EXPECT_LE(make_axis({0.0, tiny}, "", "kg").ticks.size(), 9u);
  for (const double value : {1.0, 1e17, 1e-300, 1e300}) {
    const Axis axis = make_axis({value, std::nextafter(value, 2.0 * value)}, "", "kg");
    EXPECT_LE(axis.ticks.size(), 9u) << value;
  }
}

TEST(Range, HoldsTheFiniteValues) {
  Range range;
  range.add((Vector(4) << 3.0, -1.0, kInfinity, kNaN).finished());
  EXPECT_EQ(range.lower, -1.0);
  EXPECT_EQ(range.upper, 3.0);
  EXPECT_EQ(range.widened(0.25).lower, -2.0);
  EXPECT_EQ(range.widened(0.25).upper, 4.0);
}

TEST(Range, OfOneValueOrNoneCanBeShown) {
  EXPECT_EQ(Range{}.widened(0.1).upper, 1.0);
  for (const double value : {0.0, -5.0, 1e9}) {
    const Range range = Range{value, value}.widened(0.1);
    EXPECT_LT(range.lower, value);
    EXPECT_GT(range.upper, value);
  }
}

TEST(Axis, RejectsEmptyAndInfiniteRanges) {
  EXPECT_THROW(make_axis({1.0, 1.0}, "", "m"), InputError);
  EXPECT_THROW(make_axis({0.0, kInfinity}, "", "m"), InputError);
  EXPECT_THROW(make_axis({kNaN, 1.0}, "", "m"), InputError);
}

}  // namespace
}  // namespace npdr::analysis
