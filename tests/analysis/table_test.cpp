#include "analysis/table.h"

#include "analysis/table_writers.h"
#include "core/atomic_file.h"
#include "core/constants.h"
#include "core/error.h"
#include "tests/analysis/markup_check.h"
#include "tests/temp_folder.h"

namespace npdr::analysis {
namespace {

Table table_a2() {
  Table table;
  table.name = "table_a2";
  table.caption = "Fit to 5 recordings & more";
  table.row_header = "Metric";
  table.columns = {"NPDR (MAF)", "NPDR (MAF), published", "Remark"};
  Cell dtw = Summary{1071.2, 31.25, 4997, 3};
  dtw.notes = table.footnotes = {"3 of 5000 samples failed, < 1 %"};
  table.rows = {{"DTW dist.", {dtw, MeanStd{1070, 30}, "a|b_c"}},
                {"RMSE", {MeanStd{0.2632, kNaN, 1}, MeanStd{0.263, 0.004}, {}}},
                {"Samples", {5000.0, {}, "say \"x, y\""}}};
  table.command = "npdr report \\\n  furuta.toml";
  return table;
}

TEST(Table, AsMarkdownLinesUp) {
  EXPECT_EQ(to_markdown(table_a2()),
            R"(Fit to 5 recordings & more

| Metric    |           NPDR (MAF) | NPDR (MAF), published | Remark     |
|:----------|---------------------:|----------------------:|:-----------|
| DTW dist. | [1.07 ± 0.03]e+3 (a) |      [1.07 ± 0.03]e+3 | a\|b_c     |
| RMSE      |                0.263 |         0.263 ± 0.004 |            |
| Samples   |                 5000 |                       | say "x, y" |

(a) 3 of 5000 samples failed, \< 1 %

Made by:

    npdr report \
      furuta.toml
)");
}

TEST(Table, AsCsvHasAllDigitsInColumnsOfTheirOwn) {
  EXPECT_EQ(to_csv(table_a2()),
            "Metric,NPDR (MAF) mean,NPDR (MAF) std,NPDR (MAF) n,\"NPDR (MAF), published mean\","
            "\"NPDR (MAF), published std\",\"NPDR (MAF), published n\",Remark\n"
            "DTW dist.,1071.2,31.25,4997,1070,30,,a|b_c\n"
            "RMSE,0.2632,,1,0.263,0.004,,\n"
            "Samples,5000,,,,,,\"say \"\"x, y\"\"\"\n");
}

TEST(Table, AsLatexUsesBooktabs) {
  EXPECT_EQ(to_latex(table_a2()),
            R"(% Needs \usepackage{booktabs,graphicx}; table* for both columns of a page
% Made by:
%   npdr report \
%     furuta.toml
\begin{table}
  \centering
  \caption{Fit to 5 recordings \& more}
  \label{tab:table_a2}
  \resizebox{\ifdim\width>\linewidth\linewidth\else\width\fi}{!}{%
  \begin{tabular}{lrrl}
    \toprule
    Metric & NPDR (MAF) & NPDR (MAF), published & Remark \\
    \midrule
    DTW dist. & $[1.07 \pm 0.03]\mathrm{e}{+}3$\textsuperscript{a} & $[1.07 \pm 0.03]\mathrm{e}{+}3$ & a\textbar{}b\_c \\
    RMSE & $0.263$ & $0.263 \pm 0.004$ &  \\
    Samples & $5000$ &  & say "x, y" \\
    \bottomrule
  \end{tabular}}

  {\footnotesize \textsuperscript{a} 3 of 5000 samples failed, \textless{} 1 \%\par}
\end{table}
)");
}

TEST(Table, AsLatexAlignsMeansAtTheirSigns) {
  Table table = table_a2();
  table.rows.resize(1);
  table.rows[0] = {"[a]", {MeanStd{0.5, 0.1, 10}, Cell(), "b"}};
  const std::string latex = to_latex(table);
  EXPECT_TRUE(
      has(latex, {"\\begin{tabular}{lr@{}lrl}", "Metric & \\multicolumn{2}{c}{NPDR (MAF)} & "}));
  table.rows[0].symbol = "m_p";
  EXPECT_TRUE(has(to_latex(table), "    $m_p$ & $0.500$"));
  EXPECT_TRUE(has(latex, "    {[}a] & $0.500$ & ${}\\pm 0.100$ &  & b \\\\\n"));
}

TEST(Table, AsHtmlEscapesItsText) {
  EXPECT_EQ(to_html(table_a2()),
            R"(<figure class="table" id="table-table_a2">
<figcaption>Fit to 5 recordings &amp; more</figcaption>
<div class="scroll" tabindex="0"><table>
<thead>
<tr><th>Metric</th><th class="number">NPDR (MAF)</th><th class="number">NPDR (MAF), published</th><th>Remark</th></tr>
</thead>
<tbody>
<tr><th>DTW dist.</th><td class="number">[1.07 ± 0.03]e+3<sup>a</sup></td><td class="number">[1.07 ± 0.03]e+3</td><td>a|b_c</td></tr>
<tr><th>RMSE</th><td class="number">0.263</td><td class="number">0.263 ± 0.004</td><td></td></tr>
<tr><th>Samples</th><td class="number">5000</td><td class="number"></td><td>say &quot;x, y&quot;</td></tr>
</tbody>
</table></div>
<p class="note"><sup>a</sup> 3 of 5000 samples failed, &lt; 1 %</p>
</figure>
)");
}

TEST(Table, AsHtmlBreaksLongTextsIntoLinesAndCanBeFolded) {
  Table table = table_a2();
  table.rows.front().cells.back() = Cell("FAR above what can be reached");
  table.is_folded = true;
  const std::string html = to_html(table);
  EXPECT_TRUE(has(html, {"<details>\n<summary>Fit to 5 recordings &amp; more</summary>\n<div",
                         "<td class=\"words\">FAR above"}));
  EXPECT_EQ(count_of(html, "class=\"words\""), 1);
  EXPECT_EQ(markup_error(html), "");
}

// One row of these cells, all of them compared but the last.
Table compared(const std::vector<Cell>& cells, std::optional<double> ideal) {
  Table table;
  table.name = "compared";
  table.columns.assign(cells.size(), "A");
  table.rows = {{"row", cells, "", ideal}};
  for (std::size_t c = 0; c + 1 < cells.size(); ++c) table.compared.push_back(c);
  return table;
}

std::vector<std::size_t> best_columns(const std::vector<Cell>& cells, std::optional<double> ideal) {
  const Table table = compared(cells, ideal);
  const std::vector<bool> best = table.best_of(table.rows.front());
  std::vector<std::size_t> columns;
  for (std::size_t c = 0; c < best.size(); ++c) {
    if (best[c]) columns.push_back(c);
  }
  return columns;
}

TEST(Table, KnowsTheBestOfTheColumnsThatItCompares) {
  using Columns = std::vector<std::size_t>;
  const std::vector<Cell> cells = {MeanStd{0.8, 0.01}, MeanStd{0.93, 0.01}, MeanStd{1.0, 0.0}, 0.5};
  EXPECT_EQ(best_columns(cells, -kInfinity), Columns{0}) << "the last one doesn't compete";
  EXPECT_EQ(best_columns(cells, kInfinity), Columns{2});
  EXPECT_EQ(best_columns(cells, 0.9), Columns{1});
  EXPECT_EQ(best_columns(cells, std::nullopt), Columns{});
  EXPECT_EQ(best_columns({MeanStd{0.8, 0.01}, 0.5}, -kInfinity), Columns{}) << "one alone";
  EXPECT_EQ(best_columns({"-inf", MeanStd{-3.0, kNaN}, {}, MeanStd{kNaN, kNaN}, 1.0}, kInfinity),
            Columns{})
      << "a single number competes with none";
  EXPECT_EQ(best_columns({Index{7}, Index{3}, 3.0, 1.0}, -kInfinity), (Columns{1, 2}));
}

TEST(Table, TheBestTieInTheDigitsThatAreShown) {
  using Columns = std::vector<std::size_t>;
  // 0.263 ± 0.010 and 0.2634 ± 0.0002; 0.264 ± 0.010
  EXPECT_EQ(
      best_columns({MeanStd{0.2632, 0.01}, MeanStd{0.2634, 0.0002}, MeanStd{0.2641, 0.01}, 1.0},
                   -kInfinity),
      (Columns{0, 1}));
  EXPECT_EQ(best_columns({MeanStd{0.2632, 0.0002}, MeanStd{0.2634, 0.0002}, 1.0}, 0.0), Columns{0});
  EXPECT_EQ(best_columns({MeanStd{0.88, kNaN}, MeanStd{0.92, kNaN}, 1.0}, 0.9), (Columns{0, 1}))
      << "on both sides";
  EXPECT_EQ(best_columns({MeanStd{1071.2, 31.0}, MeanStd{1068.0, 40.0}, 1.0}, 0.0), (Columns{0, 1}))
      << "[1.07 ± 0.03]e+3 both";
}

TEST(Table, ShowsTheBestBoldButInCsv) {
  Table table = compared({MeanStd{0.25, 0.01}, MeanStd{0.5, 0.01}, MeanStd{0.1, 0.01}}, -kInfinity);
  table.rows[0].cells[0].notes = table.footnotes = {"note"};
  EXPECT_TRUE(has(to_markdown(table), "| row | **0.250 ± 0.010** (a) | 0.500 ± 0.010 |"));
  EXPECT_TRUE(has(to_html(table), "<b>0.250 ± 0.010</b><sup>a</sup></td>"));
  EXPECT_EQ(markup_error(to_html(table)), "");
  EXPECT_TRUE(has(to_latex(table), "row & \\boldmath$0.250$ & \\boldmath${}\\pm 0.010$"));
  EXPECT_EQ(count_of(to_latex(table), "boldmath"), 2);
  Table plain = table;
  plain.compared.clear();
  EXPECT_EQ(to_csv(table), to_csv(plain));
  table.rows[0].cells[0] = MeanStd{0.00025, 0.00001};
  EXPECT_TRUE(has(to_latex(table), "& \\boldmath$[2.50 \\pm 0.10]")) << "not split at its sign";
}

// Unlike a number, a count is never rounded.
TEST(Table, WritesCountsFlushRightAndInFull) {
  Table table;
  table.name = "counts";
  table.columns = {"simulations"};
  table.rows = {{"one", {Index{1234567}}}, {"all", {Index{8}}}};
  EXPECT_EQ(to_markdown(table),
            "|     | simulations |\n|:----|------------:|\n"
            "| one |     1234567 |\n| all |           8 |\n");
  EXPECT_EQ(to_csv(table), ",simulations\none,1234567\nall,8\n");
  EXPECT_TRUE(has(to_latex(table), {"{lr}", "one & 1234567 "}));
  EXPECT_TRUE(has(to_html(table), "<td class=\"number\">1234567</td>"));
}

TEST(Table, IsWrittenInEveryFormatAndRemovedAgain) {
  const TempFolder folder;
  const Table table = table_a2();
  write_table(table, folder / "tables");
  EXPECT_EQ(text_of(folder / "tables/table_a2.md"), to_markdown(table));
  EXPECT_EQ(text_of(folder / "tables/table_a2.csv"), to_csv(table));
  EXPECT_EQ(text_of(folder / "tables/table_a2.tex"), to_latex(table));
  EXPECT_EQ(table_files("table_a2", folder / "tables").size(), 3u);
  remove_table("table_a2", folder / "tables");
  EXPECT_TRUE(std::filesystem::is_empty(folder / "tables"));
}

TEST(Table, KeepsAFootnoteOnce) {
  Table table;
  for (const char* text : {"one", "two", "one"}) table.add_footnote(text);
  EXPECT_EQ(table.footnotes, (std::vector<std::string>{"one", "two"}));
}

TEST(Table, RejectsRaggedRowsLooseNotesAndNamesThatAreNoFileNames) {
  Table table = table_a2();
  table.rows[1].cells.pop_back();
  EXPECT_THROW(table.check(), ShapeError);
  table = table_a2();
  table.rows[0].cells[0].notes = {"another"};
  EXPECT_THROW(to_markdown(table), ShapeError);
  table = table_a2();
  table.name = "../table";
  EXPECT_THROW(table.check(), InputError);
  table = table_a2();
  table.compared = {0, 3};
  EXPECT_THROW(table.check(), ShapeError);
}

}  // namespace
}  // namespace npdr::analysis
