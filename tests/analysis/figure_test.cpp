#include "analysis/figure.h"

#include <set>

#include "core/atomic_file.h"
#include "core/constants.h"
#include "tests/analysis/drawn.h"
#include "tests/analysis/markup_check.h"

namespace npdr::analysis {
namespace {

// A panel per place of the grid, each with a line; x is in thousandths.
Figure drawn_grid_of(std::size_t rows, std::size_t columns) {
  Figure figure{.name = "grid", .columns = columns};
  const RowMatrix points = RowMatrix::Random(5, 3).cwiseAbs();
  const std::string table = add_table(figure, "x, y, z", points);
  for (std::size_t i = 0; i < rows * columns; ++i) {
    figure.panels.push_back({.title = "panel " + std::to_string(i),
                             .x = make_axis({0.0, 1e-3}, "time", "s"),
                             .y = make_axis({0.0, 1.0}, "height", "m"),
                             .series = {{SeriesKind::line, table, {0, 1}, "#123456"}}});
  }
  return figure;
}

TEST(Figure, SharesLabelsAlongRowsAndColumns) {
  const Drawn found = drawn(drawn_grid_of(2, 3));
  EXPECT_EQ(found.num_plots(), 6);
  EXPECT_EQ(count_of(found.svg, ">time [10⁻³ s]<"), 3);
  EXPECT_EQ(count_of(found.svg, ">height [m]<"), 2);
  EXPECT_EQ(count_of(found.svg, ">panel "), 6);
  EXPECT_EQ(count_of(found.svg, ">0.4<"), 3 + 2) << "a tick of every axis";
}

TEST(Figure, SaysWhereItsPanelsAreAndWhatTheyShow) {
  Figure figure = drawn_grid_of(1, 2);
  figure.panels[1].series.clear();
  figure.panels[0].tips = {{{0.0, 5e-4}, {0.5, 2.0}, "upper <left>"}};
  figure.legend = {{LegendMark::dot, "#123456", "A & B"}};
  const std::string svg = drawn(figure).svg;
  EXPECT_EQ(count_of(svg, "<rect class=\"panel\""), 1);
  EXPECT_TRUE(has(svg, {"data-x-lower=\"0\" data-x-upper=\"1\" data-x-title=\"time [10⁻³ s]\"",
                        "data-color=\"#123456\" data-name=\"A &amp; B\""}));
  const std::string tip = svg.substr(svg.find("<rect class=\"tip\""));
  EXPECT_TRUE(has(tip, "width=\"115.00\" height=\"115.00\"><title>upper &lt;left&gt;</title>"))
      << "half of a panel's 230 pixels";
}

TEST(Figure, LeavesPlacesWithoutSeriesEmpty) {
  Figure figure = drawn_grid_of(2, 2);
  figure.panels[3].series.clear();
  const Drawn found = drawn(figure);
  EXPECT_EQ(found.num_plots(), 3);
  EXPECT_EQ(count_of(found.svg, ">time [10⁻³ s]<"), 2) << "the column's lowest panel is the first";
  EXPECT_FALSE(has(found.svg, ">panel 3<"));
}

TEST(Figure, ShowsValuesInTheUnitOfTheAxis) {
  const std::string script = drawn(drawn_grid_of(1, 1)).script;
  EXPECT_TRUE(has(script, {"set xrange [0:1]",
                           "'grid_1.dat' using ($1*1000):2 with lines lw 1.6 lc rgb '#00123456'"}));
}

TEST(Figure, DrawsEveryKindOfSeries) {
  Figure figure = drawn_grid_of(1, 1);
  figure.colors = {"value", 0.0, 1.0};
  for (const SeriesKind kind :
       {SeriesKind::dots, SeriesKind::steps, SeriesKind::band, SeriesKind::area}) {
    const bool has_three = kind == SeriesKind::band;
    figure.panels[0].series.push_back(
        {kind, "1", has_three ? std::vector<Index>{0, 1, 2} : std::vector<Index>{0, 1}, "#123456"});
  }
  RowMatrix cells(4, 3);
  cells << 0, 0, 0, 0, 1, 0.5, 1, 0, 0.7, 1, 1, 1;
  const std::string table = add_table(figure, "x, y, value", cells);
  figure.panels[0].series.push_back({SeriesKind::cells, table, {0, 1, 2}});
  figure.panels[0].series.push_back({SeriesKind::segments, table, {0, 1, 2, 2}, "#123456"});
  const Drawn found = drawn(figure);
  EXPECT_EQ(found.num_plots(), 7);
  EXPECT_EQ(count_of(found.script, "set colorbox user"), 1);
  EXPECT_TRUE(
      has(found.script, {"points pt 7", "steps lw", "($1*1000):2:($3*1000):3 with vectors nohead",
                         ":3 with filledcurves fs", "y1=0", "image"}));
}

TEST(Figure, DrawsDataWithoutAnythingToShow) {
  Figure figure = drawn_grid_of(1, 2);
  figure.panels[0].series[0].table = add_table(figure, "none", RowMatrix(0, 2));
  figure.panels[1].series[0].table = add_table(figure, "NaN", RowMatrix::Constant(3, 2, kNaN));
  const Drawn found = drawn(figure);
  EXPECT_TRUE(has(found.svg, ">panel 1<"));
}

TEST(Figure, MarksPlacesInsideOfTheAxes) {
  Figure figure = drawn_grid_of(1, 1);
  const auto mark = [&](LegendMark shape, double x, double y) {
    figure.panels[0].marks = {{shape, "#123456", x, y, 1.0, LineStyle::dashed}};
    return drawn(figure).script;
  };
  EXPECT_TRUE(
      has(mark(LegendMark::diamond, 5e-4, 0.25), "at first 0.5, first 0.25 point pt 13 ps 1 "));
  EXPECT_TRUE(has(mark(LegendMark::line, 5e-4, 7.0),
                  "from first 0.5, graph 0 to first 0.5, graph 1 nohead front lw 1.5 dt 2"));
  EXPECT_FALSE(has(mark(LegendMark::diamond, 5e-4, 7.0), "first"));
  EXPECT_FALSE(has(mark(LegendMark::line, 2e-3, 0.5), "first"));
  EXPECT_FALSE(has(mark(LegendMark::dot, kNaN, 0.5), "first"));
}

TEST(Figure, LegendEntriesShowTheirMark) {
  for (const auto& [mark, command] : {std::pair{LegendMark::dot, "pt 7 ps 0.8 lc rgb '#123456'"},
                                      {LegendMark::triangle, "pt 9 "},
                                      {LegendMark::square, "pt 5 "},
                                      {LegendMark::line, "set arrow"},
                                      {LegendMark::band, "set object rectangle"}}) {
    Figure figure = drawn_grid_of(1, 1);
    figure.legend = {{mark, "#123456", "words"}};
    const std::string script = drawn(figure).script;
    EXPECT_TRUE(has(script, {command, "'words'"}));
    EXPECT_EQ(has(script, "set object rectangle"), mark == LegendMark::band);
  }
}

TEST(Figure, TextsAreTextAndNothingElse) {
  const std::string nasty = "'`touch broken`\nset output 'elsewhere'<b>&{/Bold";
  const std::string shown = "’`touch broken` set output ’elsewhere’&lt;b>&amp;{/Bold";
  Figure figure = drawn_grid_of(1, 1);
  figure.sizes.panel_width = 900.0;
  figure.panels[0].title = figure.panels[0].x.title = nasty;
  figure.panels[0].y.unit = figure.panels[0].y.labels[0] = nasty;
  figure.legend = {{LegendMark::dot, "#123456", nasty}};
  figure.colors = {nasty, 0.0, 1.0};
  figure.tables[0].comment = nasty;
  const TempFolder folder;
  const std::string svg = read_text_file(write_figure(figure, folder.path()).svg);
  EXPECT_EQ(markup_error(svg), "");
  EXPECT_GE(count_of(svg, shown), 4) << svg;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "broken"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "elsewhere"));
}

TEST(Figure, MethodsKeepTheirColor) {
  Figure figure;
  std::set<std::string> colors = {kTruthColor, kNominalColor};
  for (const char* method : {"a", "b", "c", "d", "e", "f"}) {
    colors.insert(method_color(figure, method, LegendMark::line));
  }
  EXPECT_EQ(colors.size(), kMaxMethods + 2);
  EXPECT_EQ(method_color(figure, "b", LegendMark::line), kMethodColors[1]);
  EXPECT_EQ(figure.legend.size(), kMaxMethods);
  EXPECT_THROW(method_color(figure, "g", LegendMark::line), InputError);
}

TEST(Figure, SelectionsAreTheFirstOrThoseWanted) {
  using Indices = std::vector<Index>;
  EXPECT_EQ(check_selection("x", {}, 7, 1, 3), (Indices{0, 1, 2}));
  EXPECT_EQ(check_selection("x", {}, 2, 1, 3), (Indices{0, 1}));
  EXPECT_EQ(check_selection("x", {6, 1}, 7, 1, 3), (Indices{6, 1}));
  EXPECT_THROW(check_selection("plot 'p': channel", {2}, 2, 1, 3), InputError);
  EXPECT_THROW(check_selection("plot 'p': channel", {}, 1, 2, 3), InputError);
}

}  // namespace
}  // namespace npdr::analysis
