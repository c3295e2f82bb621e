
#include "analysis/report.h"
#include "analysis/escape.h"
#include "analysis/gnuplot.h"
#include "analysis/report_script.h"
#include "analysis/svg.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/shell_call.h"
#include "core/shell_text.h"
#include "tests/analysis/markup_check.h"
#include "tests/temp_folder.h"

namespace npdr::analysis {
namespace {

Table small_table() {
  Table table;
  table.name = "fit";
  table.caption = "Fit <&>";
  table.row_header = "Metric";
  table.columns = {"NPDR"};
  table.rows = {{"RMSE", {MeanStd{0.263, 0.004, 5000}}}};
  return table;
}

Report small_report(const std::filesystem::path& directory) {
  const FigureFiles files =
      render_script({"plot", 320, 200, "unset key\nplot x with points pt 7\n"}, directory);
  Report report;
  report.title = "Results of <furuta> & \"friends\"";
  report.prose = "First paragraph,\nsecond line.\n\n  \nSecond <script>alert(1)</script>.";
  report.sections = {{"Fit & floor", "", {small_table()}, {{files.svg, "Figure one"}}},
                     {"Posterior", "Prose.", {}, {{files.svg, "Figure \"two\""}}}};
  report.commands = {"npdr run study.toml && echo done"};
  report.provenance = {{"git revision", "1a2b3c"}, {"study", "<study>"}};
  return report;
}

class ReportPage : public FolderTest {
 protected:
  Report report_ = small_report(folder_.path());
};

TEST_F(ReportPage, IsOneWellFormedPageThatLoadsNothingFromElsewhere) {
  write_report(report_, folder_ / "out/report.html");
  const std::string html = text_of(folder_ / "out/report.html");
  EXPECT_EQ(html, to_html(report_));
  EXPECT_EQ(markup_error(html), "");
  EXPECT_TRUE(html.starts_with("<!DOCTYPE html>"));
  EXPECT_TRUE(has(html, {"0.263 ± 0.004", "prefers-color-scheme: dark"}));
  // The only place on the web that may be named is a namespace.
  EXPECT_EQ(count_of(html, "http://"), count_of(html, "=\"http://www.w3.org/"));
  for (const auto& [text, count] : {std::pair{"<svg ", 2},
                                    {"<table>", 1},
                                    {"<script>", 1},
                                    {"<script ", 0},
                                    {"<link", 0},
                                    {" src=", 0},
                                    {"@import", 0},
                                    {"https://", 0},
                                    // Figures do not share ids.
                                    {"id='figure-1-1-gpPt6'", 1},
                                    {"id='figure-2-1-gpPt6'", 1},
                                    {"id='gp", 0},
                                    {"href='#gp", 0}}) {
    EXPECT_EQ(count_of(html, text), count) << text;
  }
}

TEST_F(ReportPage, RemarksStandBelowTheTables) {
  report_.sections[0].remarks = "Remark <1>.\n\nRemark 2.";
  const std::string html = to_html(report_);
  const std::size_t remark = html.find("<p>Remark &lt;1&gt;.</p>\n<p>Remark 2.</p>");
  EXPECT_LT(html.find("</table>"), remark);
  EXPECT_LT(remark, html.find("<figure class=\"plot\">"));
}

// Both as a shell knows them: the hash is of the script's bytes, in base64.
TEST_F(ReportPage, AllowsItsOwnScriptAlone) {
  folder_.file("script.js", kReportScript);
  const std::string hash =
      "printf $(sha256sum script.js | cut -c1-64 | sed 's/../\\\\x&/g') | base64 -w0 > hash";
  const CallResult shell = run_shell({{"bash -c " + shell_word(hash), folder_.path(), {}}, 60.0});
  ASSERT_EQ(shell.exit_status, 0) << shell.output;
  EXPECT_EQ("sha256-" + text_of(folder_ / "hash"), kReportScriptHash);
  const std::string html = to_html(report_);
  EXPECT_TRUE(has(html, std::string("script-src '") + kReportScriptHash + "'"));
  EXPECT_EQ(count_of(html, "'unsafe-inline'"), 1) << "of styles";
}

TEST(Report, SaysFirstWhatHoldsAndWhatFails) {
  Report report{"Title", "Prose."};
  report.verdicts = {{true, "A: 3 of 3 checks pass"},
                     {false, "B: <1> of 3 checks FAILS\nBeware", {"a & b\nc"}}};
  const std::string html = to_html(report);
  EXPECT_EQ(markup_error(html), "");
  const std::size_t holds = html.find("<li class=\"holds\">A: 3 of 3 checks pass</li>");
  const std::size_t fails = html.find(
      "<li class=\"fails\"><details><summary>B: &lt;1&gt; of 3 checks FAILS<br/>Beware</summary>\n"
      "<p>a &amp; b<br/>c</p></details></li>");
  EXPECT_LT(holds, fails);
  EXPECT_LT(fails, html.find("<p>Prose.</p>"));
  report.verdicts.erase(report.verdicts.begin());
  EXPECT_TRUE(has(to_html(report), "<details open=\"\"><summary>B")) << "of the only method";
}

TEST_F(ReportPage, FoldsSectionsAndTurnsTheirOrder) {
  report_.sections[0].figures_first = true;
  report_.sections[1].is_folded = true;
  report_.sections[1].code = "npdr sample <posterior>";
  const std::string html = to_html(report_);
  EXPECT_EQ(markup_error(html), "");
  EXPECT_LT(html.find("<figure class=\"plot\">"), html.find("<table>"));
  EXPECT_EQ(count_of(html, "<details>"), 1);
  EXPECT_TRUE(has(
      html, "<pre tabindex=\"0\"><code>npdr sample &lt;posterior&gt;</code></pre>\n</details>"));
}

TEST_F(ReportPage, ShowsAnotherDrawingWhereItIsNarrow) {
  ReportFigure& figure = report_.sections[0].figures[0];
  figure.narrow = figure.svg;
  const std::string html = to_html(report_);
  EXPECT_EQ(markup_error(html), "") << "ids are there once";
  EXPECT_EQ(count_of(html, "<svg "), 3);
  EXPECT_EQ(count_of(html, "<div class=\"drawing wide\">"), 1);
  EXPECT_EQ(count_of(html, "<div class=\"drawing narrow\">"), 1);
  EXPECT_EQ(count_of(html, "<div class=\"drawing\">"), 1) << "the other figure has one drawing";
}

TEST_F(ReportPage, EscapesEveryText) {
  const std::string html = to_html(report_);
  EXPECT_TRUE(
      has(html, {"<title>Results of &lt;furuta&gt; &amp; &quot;friends&quot;</title>",
                 "<p>First paragraph,\nsecond line.</p>\n<p>Second "
                 "&lt;script&gt;alert(1)&lt;/script&gt;.</p>",
                 "<h2>Fit &amp; floor</h2>", "<figcaption>Fit &lt;&amp;&gt;</figcaption>",
                 "npdr run study.toml &amp;&amp; echo done", "<dt>study</dt><dd>&lt;study&gt;</dd>",
                 "aria-label=\"Figure &quot;two&quot;\""}));
}

TEST_F(ReportPage, LeavesOutWhatIsEmptyAndRejectsWhatIsNoSvg) {
  const std::string html = to_html(Report{"Title", ""});
  EXPECT_EQ(markup_error(html), "");
  EXPECT_FALSE(has(html, "id=\"commands\""));
  EXPECT_FALSE(has(html, "id=\"provenance\""));
  const Report report{"Title", "", {}, {{"Section", "", {}, {{folder_ / "no.svg", "x"}}}}};
  EXPECT_THROW(to_html(report), Error);
  folder_.file("no.svg", "text");
  EXPECT_THROW(to_html(report), InputError);
}

TEST(Svg, TidyingGathersRunsOfEqualCircles) {
  EXPECT_EQ(tidy_svg("<g>\n"
                     "\t<use xlink:href='#gpPt6' transform='translate(1.5,2) scale(0.7)' "
                     "color='rgb(1, 2, 3)' opacity='0.55'/>\n"
                     "\t<use xlink:href='#gpPt6' transform='translate(3,4) scale(0.7)' "
                     "color='rgb(1, 2, 3)' opacity='0.55'/>\n"
                     "\t<use xlink:href='#gpPt6' transform='translate(5,6) scale(0.8)' "
                     "color='rgb(9, 9, 9)'/>\n"
                     "</g>\n"),
            "<g>\n"
            "<g fill='rgb(1, 2, 3)' fill-opacity='0.55' stroke='none'>\n"
            "<circle cx='1.5' cy='2' r='0.7'/>\n"
            "<circle cx='3' cy='4' r='0.7'/>\n"
            "</g>\n"
            "<g fill='rgb(9, 9, 9)' fill-opacity='1' stroke='none'>\n"
            "<circle cx='5' cy='6' r='0.8'/>\n"
            "</g>\n"
            "</g>\n");
}

TEST(Svg, TidyingLeavesOtherPointsAloneAndEndsAnOpenGroup) {
  const std::string other =
      "\t<use xlink:href='#gpPt5' transform='translate(1,2) scale(1)' color='x'/>\n"
      "\t<use xlink:href='#gpPt6' transform='translate(1,2) scale(1)' color='x' more='y'/>\n"
      "\t<use xlink:href='#gpPt6' transform='translate(1,2) scale(1)' color='x' opacity=''/>\n"
      "\t<use xlink:href='#gpPt6' transform='translate(1,2)\n";
  EXPECT_EQ(tidy_svg(other), other);
  EXPECT_EQ(
      tidy_svg("\t<use xlink:href='#gpPt6' transform='translate(1,2) scale(3)' color='red'/>"),
      "<g fill='red' fill-opacity='1' stroke='none'>\n<circle cx='1' cy='2' r='3'/>\n</g>\n");
  EXPECT_THROW(inline_svg("<html></html>", "f", "label"), InputError);
}

TEST(Svg, TidyingRemovesTitlesDescriptionsAndEndsOfRawText) {
  EXPECT_EQ(
      tidy_svg("<svg>\n<title>Gnuplot</title>\n<desc>made\nby</desc><title>2</title></svg>\n"),
      "<svg>\n\n</svg>\n");
  EXPECT_EQ(tidy_svg("<text>a]]>b</text>\n"), "<text>a]]&gt;b</text>\n");
}

TEST(Svg, InliningMakesIdsTheFiguresOwn) {
  EXPECT_EQ(inline_svg("<?xml version='1.0'?>\n<svg width='1'><path id='a'/><g id=\"b\"/>"
                       "<use xlink:href='#a'/><use href=\"#b\"/><g clip-path=\"url(#a)\"/></svg>",
                       "f1-", "A \"plot\" & more"),
            "<svg role=\"img\" aria-label=\"A &quot;plot&quot; &amp; more\" width='1'>"
            "<path id='f1-a'/><g id=\"f1-b\"/><use xlink:href='#f1-a'/><use href=\"#f1-b\"/>"
            "<g clip-path=\"url(#f1-a)\"/></svg>");
}

// Other cases are in tests/golden/text.txt.
TEST(Escape, NoneLetsThroughWhatIsntPrintable) {
  for (const auto& escape : {escape_html, escape_markdown, quote_csv}) {
    EXPECT_EQ(escape("a\x1b\xF6\u202Eb"), "a\uFFFD\uFFFD\uFFFDb");
  }
  EXPECT_EQ(escape_latex("a\x1b\xF6\u202Eb"), "a???b");
}

}  // namespace
}  // namespace npdr::analysis
