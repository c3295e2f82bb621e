#include "analysis/gnuplot.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <iterator>

#include "core/atomic_file.h"
#include "core/constants.h"
#include "core/error.h"
#include "tests/analysis/markup_check.h"
#include "tests/message_of.h"
#include "tests/temp_folder.h"

namespace npdr::analysis {
namespace {

std::string problem_of(const GnuplotScript& script, const std::filesystem::path& directory,
                       const std::string& program = "gnuplot") {
  return message_of<Error>([&] { render_script(script, directory, program); });
}

TEST(Gnuplot, MakesSvgPngAndPdfFromOneScript) {
  const TempFolder folder;
  write_data_file(folder.path() / "data.dat", "x y", RowMatrix::Identity(3, 2));
  const FigureFiles files = render_script(
      {"plot", 320, 200, "unset key\nplot 'data.dat' using 1:2 with points pt 7\n"}, folder.path());
  const std::string svg = read_text_file(files.svg);
  EXPECT_EQ(markup_error(svg), "");
  EXPECT_EQ(count_of(svg, "<circle cx="), 3);
  EXPECT_TRUE(has(svg, "width=\"320\" height=\"200\""));
  const std::string png = read_text_file(files.png);
  ASSERT_TRUE(is_png(png));
  // Width and height, two bytes each, where the header has them: twice those of the SVG.
  EXPECT_EQ(png.substr(16, 8), std::string("\0\0\x02\x80\0\0\x01\x90", 8));
  EXPECT_TRUE(read_text_file(files.pdf).starts_with("%PDF-"));
  EXPECT_TRUE(has(read_text_file(files.script), "# gnuplot -c plot.gp png plot.png"));
  const auto left = std::filesystem::directory_iterator(folder.path());
  EXPECT_EQ(std::distance(begin(left), end(left)), 5) << "and the data";
}

TEST(Gnuplot, DrawsTheSameInEveryTimeZone) {
  const TempFolder folder;
  std::vector<std::string> pdfs;
  for (const char* zone : {"UTC", "Asia/Kolkata", "EST5EDT"}) {
    setenv("TZ", zone, 1);
    const auto files = render_script({"plot", 320, 200, "plot x\n"}, folder.path());
    pdfs.push_back(read_text_file(files.pdf));
  }
  unsetenv("TZ");
  EXPECT_EQ(pdfs[1], pdfs[0]);
  EXPECT_EQ(pdfs[2], pdfs[0]);
}

TEST(Gnuplot, DrawsWhateverTerminalTheUserPrefers) {
  const TempFolder folder;
  setenv("GNUTERM", "x11", 1);
  EXPECT_NO_THROW(render_script({"plot", 320, 200, "plot x\n"}, folder.path()));
  unsetenv("GNUTERM");
}

TEST(Gnuplot, ItsErrorsComeThrough) {
  const TempFolder folder;
  const std::string message =
      problem_of({"plot", 320, 200, "plot 'missing_file.dat'\n"}, folder.path());
  EXPECT_TRUE(
      has(message, {"plot.svg: gnuplot failed with status 1 on plot.gp", "missing_file.dat"}));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "plot.svg"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "plot.svg.tmp"));
}

TEST(Gnuplot, AProgramThatLeavesNoFileIsAnError) {
  const TempFolder folder;
  EXPECT_TRUE(has(problem_of({"plot", 320, 200, ""}, folder.path(), "true"), "has drawn nothing"));
}

TEST(Gnuplot, SaysWhatToInstallWhenItIsMissing) {
  const TempFolder folder;
  EXPECT_TRUE(says(problem_of({"plot", 320, 200, "plot x\n"}, folder.path(), "npdr-no-gnuplot"),
                   {"npdr-no-gnuplot: not found", "install gnuplot (Debian package gnuplot-nox)"}));
}

TEST(Gnuplot, RejectsNamesThatAreNoFileNames) {
  const TempFolder folder;
  EXPECT_TRUE(has(problem_of({"../plot", 320, 200, ""}, folder.path()), "figure: name '../plot'"));
}

TEST(Gnuplot, StringsStandForThemselves) {
  EXPECT_EQ(gnuplot_string("it's"), "'it’s'");
  EXPECT_EQ(gnuplot_string("a\nb\t\x7f"), "'a b \uFFFD'");
  const TempFolder folder;
  const std::string nasty = "''`touch broken`\" \\n $x @y {/Bold b} <&> 10⁻³";
  const FigureFiles files = render_script(
      {"plot", 320, 200, "unset key\nset title " + gnuplot_string(nasty) + "\nplot x\n"},
      folder.path());
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "broken"));
  EXPECT_TRUE(
      has(read_text_file(files.svg), "’’`touch broken`\" \\n $x @y {/Bold b} &lt;&amp;> 10⁻³"));
}

TEST(Gnuplot, DataFilesHaveAllDigits) {
  const TempFolder folder;
  RowMatrix values(2, 2);
  values << 0.1, 1.0 / 3.0, kInfinity, -2e-300;
  write_data_file(folder.path() / "data.dat", "one\ntwo\x1b[2J", values);
  EXPECT_EQ(read_text_file(folder.path() / "data.dat"),
            "# one\uFFFDtwo\uFFFD[2J\n0.1 0.3333333333333333\nNaN -2e-300\n");
}

}  // namespace
}  // namespace npdr::analysis
