/// Names, labels and titles of hostile text through all outputs, each read by its format's parser.
#include <fmt/format.h>

#include <cmath>
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

// Each file by the parser of its format, which finds none but our own elements and commands in it.
constexpr const char* kParsers = R"py(
import csv, html.parser, json, re, sys, tomllib, xml.etree.ElementTree

class Page(html.parser.HTMLParser):
    titles = scripts = 0
    def handle_starttag(self, tag, attributes):
        assert tag not in ("b", "iframe", "object", "embed"), tag
        self.scripts += tag == "script"
        self.titles += tag == "title"
        for name, value in attributes:
            assert not name.startswith("on") and "javascript:" not in (value or ""), (name, value)

def read_html(text):
    page = Page()
    page.feed(text)
    page.close()
    assert page.titles >= 1 and page.scripts == 1  # the page's own

def read_csv(text):
    for row in csv.reader(text.splitlines(keepends=True), strict=True):
        for cell in row:
            try: float(cell)
            except ValueError: assert cell[:1] not in "=+-@" or len(cell) < 2, cell

def read_tex(text):
    text = re.sub(r"(?m)^%.*$|%$", "", text)
    commands = set(re.findall(r"\\([a-zA-Z]+)", text))
    assert not commands & {"input", "include", "write", "def", "catcode", "csname"}, commands
    bare = re.sub(r"\\.", "", text)
    assert bare.count("{") == bare.count("}") and "#" not in bare and "%" not in bare, bare

def read_md(text):
    assert not re.search(r"(?<!\\)<(script|b|/title)", text), text

readers = {"html": read_html, "csv": read_csv, "tex": read_tex, "md": read_md, "json": json.loads,
           "toml": tomllib.loads, "svg": xml.etree.ElementTree.fromstring, "gp": str, "dat": str,
           "txt": str, "log": str}
for name in sys.argv[1:]:
    readers[name.rsplit(".", 1)[1]](open(name, encoding="utf-8", newline="").read())
)py";

class HostileText : public CommandTest {
 protected:
  // What is said is text that only shows something.
  Outcome npdr(const std::vector<std::string>& words) const { return npdr(0, words); }
  Outcome npdr(int status, const std::vector<std::string>& words) const {
    const Outcome outcome = CommandTest::npdr(status, words);
    for (const std::string& text : {outcome.out, outcome.err}) EXPECT_EQ(printable(text), text);
    return outcome;
  }

  // The text of all files is UTF-8 that only shows something, and its format's parser takes it.
  // Returns how many there were.
  Index expect_parsed(const std::filesystem::path& made) const {
    folder_.file("parse.py", kParsers);
    std::string parse =
        "cd '" + made.string() + "' && python3 -I '" + (folder_ / "parse.py").string() + "'";
    Index num_files = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(made)) {
      const std::string extension = entry.path().extension();
      if (!entry.is_regular_file() || extension == ".h5" || extension == ".png" ||
          extension == ".pdf") {
        continue;
      }
      ++num_files;
      const std::string text = text_of(entry.path());
      EXPECT_EQ(printable(text), text) << entry.path();
      parse += " '" + entry.path().lexically_relative(made).string() + "'";
    }
    EXPECT_EQ(std::system(parse.c_str()), 0) << parse;
    return num_files;
  }
};

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

// A recording whose action is called so.
std::string swing(const std::string& action, double amplitude = 1.0) {
  std::string table = "t [s],theta [rad],theta_dot [rad/s],\"" + action + " [N m]\"\n";
  for (int t = 0; t < 60; ++t) {
    const double time = 0.02 * t;
    table += fmt::format("{:.3f},{:.6f},{:.6f},0\n", time, amplitude * std::sin(time),
                         amplitude * std::cos(time));
  }
  return table;
}

TEST_F(HostileText, IsTextInAllOutputs) {
  folder_.file("s.toml", hostile_study());
  folder_.file("x_o.csv", "\"" + kLabel + " [m]\",b\x07 [\x1b]\n0.5,0.3\n");
  const std::string work = "w\xF6rk \x1b[1m]]>";
  npdr({"run", "s.toml", "--work", work});
  const std::filesystem::path made = folder_.path() / work / "hostile";
  const std::string report = text_of(made / "report.html");
  EXPECT_EQ(analysis::markup_error(report), "");
  EXPECT_EQ(analysis::count_of(report, "<script"), 1) << "the page's own";
  EXPECT_EQ(printable(report), report);
  EXPECT_GT(expect_parsed(made), 10);

  const auto is_json = [](const std::string& text) { return nlohmann::json::accept(text); };
  EXPECT_TRUE(is_json(npdr({"status", "s.toml", "--work", work, "--json"}).out));
  npdr({"validate", "s.toml"});
  const std::string round = work + "/hostile/" + folder_slug(kMethod) + "/seed-1/round-1/";
  npdr({"inspect", round + "simulate.h5"});
  EXPECT_TRUE(is_json(npdr({"inspect", "--study", round + "infer.h5"}).out));
  npdr({"sample", round + "infer.h5", "-n", "2"});
  folder_.file("a.csv", kLabel + "\n" + "1\n2\n3\n4\n5\n6\n7\n8\n9\n10\n");
  npdr({"compare", "a.csv", "a.csv"});
  EXPECT_TRUE(is_json(npdr({"compare", "a.csv", "a.csv", "--json"}).out));
}

// Names of files and channels on the way from a lab's CSV to scripts for a cluster.
TEST_F(HostileText, IsTextFromTheRecordingToTheJobs) {
  const std::string channel = "torque $(touch pwned) `touch pwned` ]]><script> \\input|x";
  const std::vector<std::string> names = {
      "a$(touch pwned)`touch pwned`\x1b[31m\xF6\n;touch pwned; '\"|x]]><script>.csv",
      "=cmd|'!A0.csv"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    folder_.file(names[i], swing(channel, 1.0 + static_cast<double>(i)));
  }
  const std::string recording = "r$(touch pwned)`touch pwned`'\"]]><script>.h5";
  npdr({"import", names[0], names[1], "--states", "theta [rad],theta_dot [rad/s]", "--actions",
        channel + " [N m]", "-o", recording});
  npdr({"inspect", recording});
  const std::string worker = "sh -c 'read a' # $(touch pwned) \"q\"";
  npdr({"new", "hostile", "--recording", recording, "--worker", worker});
  npdr({"validate", "hostile.toml"});
  const std::string work = "w$(touch pwned)`touch pwned`'";
  folder_.file("tasks.sh", npdr({"tasks", "hostile.toml", "--work", work}).out);
  folder_.file("jobs.sh", npdr({"submit", "hostile.toml", "--dry-run", "--work", work}).out);
  for (const char* script : {"tasks.sh", "jobs.sh"}) {
    const std::string check = "bash -n '" + (folder_ / script).string() + "'";
    EXPECT_EQ(std::system(check.c_str()), 0) << text_of(folder_ / script);
  }
  // Each line is one command, whose words are the names.
  folder_.file(
      "words.sh",
      "while read -r line; do eval \"set -- $line\"; printf '%s\\n' \"$@\"; done < tasks.sh");
  const std::string tell = "cd '" + folder_.path().string() + "' && bash words.sh > words.txt";
  EXPECT_EQ(std::system(tell.c_str()), 0);
  EXPECT_TRUE(has(text_of(folder_ / "words.txt"), "\n" + work + "\n"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "pwned"));

  npdr({"import", names[1], "--states", "theta [rad],theta_dot [rad/s]", "--actions",
        channel + " [N m]", "-o", "r\x1b\n.h5"});
  const Outcome refused =
      npdr(2, {"new", "broken", "--recording", "r\x1b\n.h5", "--worker", worker});
  EXPECT_TRUE(has(refused.err, "--recording = 'r"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "broken.toml"));
}

TEST_F(HostileText, MakesNoCommandsOfLineBreaks) {
  folder_.file("s.toml", small_study());
  const Outcome outcome = npdr(2, {"tasks", "s.toml", "--work", "a\ntouch b\n"});
  EXPECT_EQ(outcome.out, "");
  EXPECT_TRUE(has(outcome.err, "has a line break"));
}

}  // namespace
}  // namespace npdr::pipeline
