// Texts of reports and tables.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "analysis/escape.h"
#include "analysis/latex_symbols.h"
#include "analysis/number_text.h"
#include "core/constants.h"

namespace npdr::analysis {
namespace {

TEST(Escape, HtmlKeepsMarkupFromTextAndAttributes) {
  EXPECT_EQ(escape_html("<b a=\"1\" c='2'>&"), "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp;");
}

TEST(Escape, MarkdownKeepsACellInItsColumn) {
  EXPECT_EQ(escape_markdown("a|b\nc_d *x* `y` <z> \\"), "a\\|b c_d \\*x\\* \\`y\\` \\<z> \\\\");
}

TEST(Escape, LatexCoversAllSpecialCharacters) {
  EXPECT_EQ(escape_latex("50% of $1 & #2_{a}"), "50\\% of \\$1 \\& \\#2\\_\\{a\\}");
  EXPECT_EQ(escape_latex("~^\\<>"),
            "\\textasciitilde{}\\textasciicircum{}\\textbackslash{}\\textless{}\\textgreater{}");
  EXPECT_EQ(escape_latex("[a|b] * ≥"), "{[}a\\textbar{}b] {*} $\\geq$");
}

TEST(Escape, NoneLetsThroughWhatIsntPrintable) {
  for (const auto& escape : {escape_html, escape_markdown, quote_csv}) {
    EXPECT_EQ(escape("a\x1b\xF6\u202Eb"), "a\uFFFD\uFFFD\uFFFDb");
  }
  EXPECT_EQ(escape_latex("a\x1b\xF6\u202Eb"), "a???b");
}

TEST(Escape, CsvHasNoFormulasAndQuotesOnlyWhatNeedsIt) {
  for (const auto& [text, quoted] : {std::pair{"=HYPERLINK(\"x\")", "\"'=HYPERLINK(\"\"x\"\")\""},
                                     {"+a", "'+a"},
                                     {"@a", "'@a"},
                                     {"-1-2", "'-1-2"},
                                     {"a,b", "\"a,b\""},
                                     {"say \"hi\"\n", "\"say \"\"hi\"\"\n\""}}) {
    EXPECT_EQ(quote_csv(text), quoted);
  }
  for (const char* same : {"-1.5", "+2", "-3e-05", "-inf", "a = b", "plain text"}) {
    EXPECT_EQ(quote_csv(same), same);
  }
}

TEST(LatexSymbols, AreCommandsOfPlainLatex) {
  EXPECT_EQ(latex_symbols("p ≥ 0.1, 3 ± 1, 90°"), "p $\\geq$ 0.1, 3 $\\pm$ 1, 90$^\\circ$");
  EXPECT_EQ(latex_symbols("10⁻³ kg m², log₁₀ θ, Ω"),
            "10$^{-}$$^{3}$ kg m$^{2}$, log$_{1}$$_{0}$ $\\theta$, $\\Omega$");
  EXPECT_EQ(latex_symbols("“a” – ‘b’…"), "``a'' -- `b'\\ldots{}");
}

TEST(LatexSymbols, LettersWithAccentsStay) {
  EXPECT_EQ(latex_symbols("Müller, Ångström, ñ"), "Müller, Ångström, ñ");
}

TEST(LatexSymbols, WhatNoFontHasIsNamed) {
  EXPECT_EQ(latex_symbols("中 \U0001F600 Þ"), "U+4E2D U+1F600 U+00DE");
  EXPECT_EQ(latex_symbols("\uFFFD"), "?");
}

TEST(LatexSymbols, OfUsersAreFormulasAndNothingElse) {
  for (const char* good :
       {"m_p", "\\theta", "\\dot{\\theta}_0", "k_{\\mathrm{m}}", "R_m^2", "D'"}) {
    EXPECT_TRUE(is_latex_symbol(good)) << good;
  }
  for (const char* bad :
       {"", "\\input{/etc/passwd}", "\\write18{ls}", "m$", "a%b", "m_", "\\dot", "{", "}{", "a_b_c",
        "\\thetaX", "#1", "a\nb", "m_p & x", "\\\\", "^^5cinput x", "≥"}) {
    EXPECT_FALSE(is_latex_symbol(bad)) << bad;
  }
  EXPECT_FALSE(is_latex_symbol(std::string(100, 'a')));
}

struct TextCase {
  double mean, std;
  std::string text;
};

void expect_texts(NumberStyle style, const std::vector<TextCase>& cases) {
  for (const auto& [mean, std, text] : cases) EXPECT_EQ(mean_std_text(mean, std, style), text);
}

TEST(NumberText, WritesMeansAndDeviationsAsThePaperDoes) {
  expect_texts(NumberStyle::plain, {{0.263, 0.004, "0.263 ± 0.004"},
                                    {0.274, 0.021, "0.274 ± 0.021"},
                                    {1070.0, 30.0, "[1.07 ± 0.03]e+3"},
                                    {0.745, 1e-16, "0.745 ± 0.000"},  // equal numbers
                                    // The small and the large are scaled.
                                    {1e-6, 2e-7, "[1.00 ± 0.20]e-6"},
                                    {-2.5e4, 400.0, "[-2.50 ± 0.04]e+4"},
                                    {490.3, 11.9, "490 ± 12"},
                                    {-2464.538, 0.021, "-2464.54 ± 0.02"},
                                    {2464.0, 1.0, "[2.464 ± 0.001]e+3"},
                                    {0.00123, 0.0004, "0.00123 ± 0.00040"},
                                    // Digits follow the larger and still show the spread.
                                    {0.263, 1e-5, "0.26300 ± 0.00001"},
                                    {0.001, 2.5, "0.00 ± 2.50"},
                                    {12.3, 1400.0, "[0.01 ± 1.40]e+3"},
                                    {1e6, 1e-8, "[1.00000000 ± 0.00000000]e+6"},
                                    {0.0, 0.0, "0.00 ± 0.00"},
                                    // 999.7 has three digits before rounding and four after.
                                    {999.7, 30.0, "[1.00 ± 0.03]e+3"},
                                    {9.999, 0.1, "10.0 ± 0.1"},
                                    // What is not known is left out.
                                    {0.263, kNaN, "0.263"},
                                    {7.26e-4, kNaN, "7.26e-4"},
                                    {kNaN, 0.1, "n/a"}});
  expect_texts(NumberStyle::latex, {{0.263, 0.004, "$0.263 \\pm 0.004$"},
                                    {1070.0, 30.0, "$[1.07 \\pm 0.03]\\mathrm{e}{+}3$"},
                                    {1e-6, 2e-7, "$[1.00 \\pm 0.20]\\mathrm{e}{-}6$"},
                                    {1070.0, kNaN, "$1.07\\mathrm{e}{+}3$"}});
}

TEST(NumberText, WritesNumbersShort) {
  for (const auto& [value, text] : {std::pair{5000.0, "5000"},
                                    {-0.0, "0"},
                                    {8.4, "8.4"},
                                    {1234.56, "1235"},
                                    {2.9e-4, "2.9e-4"},
                                    {99999.6, "1e5"},
                                    {1234567.0, "1.235e6"},
                                    {kNaN, "n/a"},
                                    {-kInfinity, "-inf"}}) {
    EXPECT_EQ(number_text(value, NumberStyle::plain), text);
  }
  for (const auto& [value, text] :
       {std::pair{2.9e-4, "$2.9 \\times 10^{-4}$"}, {8.4, "$8.4$"}, {kInfinity, "$\\infty$"}}) {
    EXPECT_EQ(number_text(value, NumberStyle::latex), text);
  }
}

}  // namespace
}  // namespace npdr::analysis
