#include "analysis/escape.h"

#include <gtest/gtest.h>

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

TEST(Escape, CsvHasNoFormulas) {
  EXPECT_EQ(quote_csv("=HYPERLINK(\"x\")"), "\"'=HYPERLINK(\"\"x\"\")\"");
  EXPECT_EQ(quote_csv("+a"), "'+a");
  EXPECT_EQ(quote_csv("@a"), "'@a");
  EXPECT_EQ(quote_csv("-1-2"), "'-1-2");
  for (const char* number : {"-1.5", "+2", "-3e-05", "-inf"}) EXPECT_EQ(quote_csv(number), number);
  EXPECT_EQ(quote_csv("a = b"), "a = b");
}

TEST(Escape, CsvQuotesOnlyWhatNeedsIt) {
  EXPECT_EQ(quote_csv("plain text"), "plain text");
  EXPECT_EQ(quote_csv("a,b"), "\"a,b\"");
  EXPECT_EQ(quote_csv("say \"hi\"\n"), "\"say \"\"hi\"\"\n\"");
}

}  // namespace
}  // namespace npdr::analysis
