#include "analysis/gnuplot.h"

#include <cstdlib>
#include <iterator>
#include <set>

#include "core/atomic_file.h"
#include "core/constants.h"
#include "core/error.h"
#include "tests/analysis/markup_check.h"
#include "tests/temp_folder.h"

namespace npdr::analysis {
namespace {

class Gnuplot : public FolderTest {
 protected:
  FigureFiles rendered(const std::string& commands) const {
    return render_script({"plot", 320, 200, commands}, folder_.path());
  }
  std::string error_of(const std::string& commands, const std::string& program = "gnuplot",
                       const std::string& name = "plot") const {
    return message_of<Error>([&] {
      render_script({name, 320, 200, commands}, folder_.path(), program);
    });
  }
};

TEST_F(Gnuplot, MakesSvgPngAndPdfFromOneScript) {
  write_data_file(folder_ / "data.dat", "x y", RowMatrix::Identity(3, 2));
  const FigureFiles files =
      render_script({"plot", 320, 200, "unset key\nplot 'data.dat' using 1:2 with points pt 7\n"},
                    folder_.path());
  const std::string svg = text_of(files.svg);
  EXPECT_EQ(markup_error(svg), "");
  EXPECT_EQ(count_of(svg, "<circle cx="), 3);
  EXPECT_TRUE(has(svg, "width=\"320\" height=\"200\""));
  const std::string png = text_of(files.png);
  ASSERT_TRUE(is_png(png));
  // Width and height, two bytes each, where the header has them: twice those of the SVG.
  EXPECT_EQ(png.substr(16, 8), std::string("\0\0\x02\x80\0\0\x01\x90", 8));
  EXPECT_TRUE(text_of(files.pdf).starts_with("%PDF-"));
  EXPECT_TRUE(has(text_of(files.script), "# gnuplot -c plot.gp png plot.png"));
  const auto left = std::filesystem::directory_iterator(folder_.path());
  EXPECT_EQ(std::distance(begin(left), end(left)), 5) << "and the data";
}

TEST_F(Gnuplot, DrawsTheSameInEveryTimeZoneWhateverTerminalTheUserPrefers) {
  std::set<std::string> pdfs;
  setenv("GNUTERM", "x11", 1);
  for (const char* zone : {"UTC", "Asia/Kolkata", "EST5EDT"}) {
    setenv("TZ", zone, 1);
    pdfs.insert(text_of(rendered("plot x\n").pdf));
  }
  unsetenv("TZ");
  unsetenv("GNUTERM");
  EXPECT_EQ(pdfs.size(), 1u);
}

TEST_F(Gnuplot, ItsErrorsComeThrough) {
  EXPECT_TRUE(has(error_of("plot 'missing_file.dat'\n"),
                  {"plot.svg: gnuplot failed with status 1 on plot.gp", "missing_file.dat"}));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "plot.svg"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "plot.svg.tmp"));
  EXPECT_TRUE(has(error_of("", "true"), "has drawn nothing"));
  EXPECT_TRUE(says(error_of("plot x\n", "npdr-no-gnuplot"),
                   {"npdr-no-gnuplot: not found", "install gnuplot (Debian package gnuplot-nox)"}));
  EXPECT_TRUE(has(error_of("", "gnuplot", "../plot"), "figure: name '../plot'"));
}

TEST_F(Gnuplot, StringsStandForThemselves) {
  EXPECT_EQ(gnuplot_string("it's"), "'it’s'");
  EXPECT_EQ(gnuplot_string("a\nb\t\x7f"), "'a b \uFFFD'");
}

TEST_F(Gnuplot, DataFilesHaveAllDigits) {
  RowMatrix values(2, 2);
  values << 0.1, 1.0 / 3.0, kInfinity, -2e-300;
  write_data_file(folder_ / "data.dat", "one\ntwo\x1b[2J", values);
  EXPECT_EQ(text_of(folder_ / "data.dat"),
            "# one\uFFFDtwo\uFFFD[2J\n0.1 0.3333333333333333\nNaN -2e-300\n");
}

}  // namespace
}  // namespace npdr::analysis
