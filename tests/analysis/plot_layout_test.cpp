#include "analysis/plot_layout.h"

#include <gtest/gtest.h>

#include <set>

namespace npdr::analysis {
namespace {

TEST(PlotLayout, MeasuresFromTheTopLeftInPixels) {
  const PlotLayout layout(200.0, 100.0);
  EXPECT_EQ(layout.at(50.0, 25.0), "screen 0.25000, screen 0.75000");
  EXPECT_EQ(layout.margins({20.0, 10.0, 100.0, 50.0}),
            "set lmargin at screen 0.10000\nset rmargin at screen 0.60000\n"
            "set tmargin at screen 0.90000\nset bmargin at screen 0.40000\n");
  EXPECT_EQ(layout.text(0.0, 100.0, "it's", "left"),
            "set label 'it’s' at screen 0.00000, screen 0.00000 left\n");
}

TEST(PlotLayout, OpacityBecomesGnuplotsTransparency) {
  EXPECT_EQ(translucent("#0072b2", 1.0), "'#000072b2'");
  EXPECT_EQ(translucent("#0072b2", 0.0), "'#ff0072b2'");
}

TEST(PlotLayout, ColorsDiffer) {
  std::set<std::string> colors(std::begin(kMethodColors), std::end(kMethodColors));
  colors.insert({kTruthColor, kNominalColor});
  EXPECT_EQ(colors.size(), kMaxMethods + 2);
}

TEST(PlotLayout, WrapsTextAtBlanksAndUnderscores) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(wrap_text("voltage_dead_zone_neg", 80.0, 10.0), (Lines{"voltage dead", "zone neg"}));
  EXPECT_EQ(wrap_text("unbreakable_word", 10.0, 10.0), (Lines{"unbreakable", "word"}));
  EXPECT_EQ(wrap_text("theta", 1000.0, 10.0), (Lines{"theta"}));
  EXPECT_EQ(wrap_text("__a__b", 1000.0, 10.0), (Lines{"a b"}));
}

TEST(PlotLayout, ElidesTheMiddle) {
  EXPECT_EQ(elide_text("short", 1000.0, 10.0), "short");
  EXPECT_EQ(elide_text("abcdefghij", 30.0, 10.0), "ab…ij");
  EXPECT_EQ(elide_text("ααααβββ", 20.0, 10.0), "α…β");  // never half a character
  EXPECT_EQ(elide_text("abcdef", 0.0, 10.0), "…");
}

TEST(PlotLayout, WidthCountsCharactersRatherThanBytes) {
  EXPECT_EQ(text_width("10⁻³", 10.0), text_width("1000", 10.0));
}

TEST(PlotLayout, LegendEntriesShowTheirMark) {
  const PlotLayout layout(100.0, 100.0);
  const auto commands = [&](LegendMark mark) {
    return legend_commands(layout, {mark, "#123456", "words"}, 10.0, 10.0, 9.0);
  };
  EXPECT_NE(commands(LegendMark::dot).find("pt 7 ps 0.8 lc rgb '#123456'"), std::string::npos);
  EXPECT_NE(commands(LegendMark::triangle).find("pt 9"), std::string::npos);
  EXPECT_NE(commands(LegendMark::diamond).find("pt 13"), std::string::npos);
  EXPECT_NE(commands(LegendMark::line).find("set arrow"), std::string::npos);
  EXPECT_NE(commands(LegendMark::band).find("set object rectangle"), std::string::npos);
  EXPECT_NE(commands(LegendMark::band).find("'words'"), std::string::npos);
}

}  // namespace
}  // namespace npdr::analysis
