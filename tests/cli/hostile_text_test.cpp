/// Names, labels and titles of hostile text through all outputs, each read by its format's parser.
#include <cstdlib>

#include "core/printable.h"
#include "pipeline/config/study.h"
#include "tests/analysis/markup_check.h"
#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

// Latin-1, an escape sequence, an override of the direction of text; ends of XML and HTML; a
// formula.
const std::string kLabel = "=1+1]]><script>alert(1)</script>\xF6\x1b[31m\xE2\x80\xAE";
const std::string kTitle = "]]></title><script>alert(1)</script> & \\\\input{x} %$_#^~ \\u202e";
const std::string kMethod = "=cmd|' /C calc'!A0 ]]><b>";

// SVG as XML, tables as CSV: arguments are files.
constexpr const char* kParsers = R"(
import csv, sys, xml.etree.ElementTree
for name in sys.argv[1:]:
    if name.endswith(".svg"):
        xml.etree.ElementTree.parse(name)
    else:
        for row in csv.reader(open(name, encoding="utf-8", newline=""), strict=True):
            for cell in row:
                try: float(cell)
                except ValueError: assert cell[:1] not in "=+-@" or len(cell) < 2, cell
)";

std::string hostile_study() {
  return command_study("hostile")
      .with("simulator",
            {"command = \"head -n 1 x_o.csv > {x}; awk -F, 'NR > 1 {print $1 \\\",\\\" $1 * $2}' "
             "{theta} >> {x}\""})
      .method(kMethod, {"num_simulations = 100", kSmallMixture, "training = { max_epochs = 3 }"})
      .with("evaluate", {"num_samples = 40"})
      .with("diagnose", {"num_simulations = 40", "num_samples = 40"})
      .with("report", {"title = \"" + kTitle + "\"", "caption = \"" + kTitle + "\""});
}

TEST(HostileText, IsTextInAllOutputs) {
  const TempFolder folder;
  folder.file("s.toml", hostile_study());
  folder.file("x_o.csv", "\"" + kLabel + " [m]\",b\x07 [\x1b]\n0.5,0.3\n");
  folder.file("parse.py", kParsers);
  const std::string work = "w\xF6rk \x1b[1m]]>";
  const auto npdr = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "npdr");
    const Outcome outcome = run(folder.path(), words);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(printable(outcome.out), outcome.out) << words[1];
    EXPECT_EQ(printable(outcome.err), outcome.err) << words[1];
    return outcome;
  };
  npdr({"run", "s.toml", "--work", work});
  const std::filesystem::path made = folder.path() / work / "hostile";
  const std::string report = text_of(made / "report.html");
  EXPECT_EQ(analysis::markup_error(report), "");
  EXPECT_EQ(report.find("<script>"), std::string::npos);
  EXPECT_EQ(printable(report), report);
  std::string parse =
      "cd '" + made.string() + "' && python3 -I '" + (folder / "parse.py").string() + "'";
  Index num_files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(made)) {
    const std::string extension = entry.path().extension();
    const bool is_text = extension == ".md" || extension == ".tex" || extension == ".gp";
    const bool is_parsed = extension == ".csv" || extension == ".svg";
    if (!is_text && !is_parsed) continue;
    ++num_files;
    const std::string text = text_of(entry.path());
    EXPECT_EQ(printable(text), text) << entry.path();
    if (is_parsed) parse += " '" + entry.path().lexically_relative(made).string() + "'";
  }
  EXPECT_GT(num_files, 10);
  EXPECT_EQ(std::system(parse.c_str()), 0) << parse;

  const auto is_json = [](const std::string& text) { return nlohmann::json::accept(text); };
  EXPECT_TRUE(is_json(npdr({"status", "s.toml", "--work", work, "--json"}).out));
  npdr({"validate", "s.toml"});
  const std::string round = work + "/hostile/" + folder_slug(kMethod) + "/seed-1/round-1/";
  npdr({"inspect", round + "simulate.h5"});
  EXPECT_TRUE(is_json(npdr({"inspect", "--study", round + "infer.h5"}).out));
  npdr({"sample", round + "infer.h5", "-n", "2"});
  folder.file("a.csv", kLabel + "\n" + "1\n2\n3\n4\n5\n6\n7\n8\n9\n10\n");
  npdr({"compare", "a.csv", "a.csv"});
  EXPECT_TRUE(is_json(npdr({"compare", "a.csv", "a.csv", "--json"}).out));
}

TEST(HostileText, MakesNoCommandsOfLineBreaks) {
  const TempFolder folder;
  folder.file("s.toml", small_study());
  const Outcome outcome = run(folder.path(), {"npdr", "tasks", "s.toml", "--work", "a\ntouch b\n"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_NE(outcome.err.find("has a line break"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace npdr::pipeline
