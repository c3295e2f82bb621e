// What is said of recordings and datasets that are imported: tests/golden/import.txt.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cmath>
#include <map>

#include "core/random.h"
#include "core/text.h"
#include "pipeline/apps/commands.h"
#include "tests/golden_file.h"

namespace npdr::pipeline {
namespace {

// How a lab writes two rollouts of a pendulum that swings, 201 rows each.
struct Lab {
  std::map<std::string, double> settings;

  // "jitter=0.6 wraps": what isn't given is 0, or as if it weren't there.
  explicit Lab(const std::string& words) {
    std::istringstream stream(words);
    for (std::string word; stream >> word;) {
      const std::size_t sign = word.find('=');
      settings[word.substr(0, sign)] =
          sign == std::string::npos ? 1.0 : std::stod(word.substr(sign + 1));
    }
  }
  double of(const std::string& name, double otherwise = 0.0) const {
    const auto found = settings.find(name);
    return found == settings.end() ? otherwise : found->second;
  }

  std::string csv(bool is_first) const {
    const double amplitude = is_first ? 0.5 : 0.8;
    const double clock = of("clock", 1.0) * (is_first ? 1.0 : of("clock_of_b", 1.0));
    std::string text = of("no_rates") != 0.0 ? "t [s],theta [rad],torque [N m]\n"
                                             : "t [s],theta [rad],theta_dot [rad/s],torque [N m]\n";
    Stream stream({1, "clock", 0, 0, 0});
    const int count = is_first ? 201 : static_cast<int>(of("count", 201.0));
    for (int i = 0; i < count; ++i) {
      const double t = 0.02 * (i + of("jitter") * (stream.uniform() - 0.5));
      if (of("gap") != 0.0 && i >= 40 && i < 100 && i % 4 != 0) continue;
      const double seen = of("still") != 0.0 && i >= 40 && i < 60 ? 0.8 : t;
      double angle = 3.0 + amplitude * std::sin(3.0 * seen);
      if (of("wraps") != 0.0) angle = std::remainder(angle, 2.0 * M_PI);
      if (i == 57) angle += of("glitch");
      text += fmt::format("{:.6f},{:.6f},", t * clock, of("factor", 1.0) * angle);
      if (of("no_rates") == 0.0) {
        text +=
            fmt::format("{:.6f},", of("rate_factor", 1.0) * 3.0 * amplitude * std::cos(3.0 * t));
      }
      text += fmt::format("{:.3f}\n", 0.1 * i);
    }
    return text;
  }
};

// A folder of recordings, in which a command runs.
class Import {
 public:
  explicit Import(const GoldenCase& given) : before_(std::filesystem::current_path()) {
    std::filesystem::current_path(folder_.path());
    write("a.csv", given.text);
    for (const std::string& line : given.input) read(line, given.text);
  }
  ~Import() { std::filesystem::current_path(before_); }
  Import(const Import&) = delete;
  Import& operator=(const Import&) = delete;

  std::string said() const {
    CLI::App app("", "npdr");
    int status = 0;
    add_command(app, {"import", "", &import_command}, status);
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    try {
      app.parse("import " + (command_.empty() ? usual_command() : command_));
    } catch (const CLI::ParseError& error) {
      ADD_FAILURE() << error.what();
    }
    const std::string out = testing::internal::GetCapturedStdout();
    const std::string err = testing::internal::GetCapturedStderr();
    EXPECT_EQ(status, err.empty() ? 0 : 2) << err;
    std::ptrdiff_t num_files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      num_files += entry.path().extension() == ".h5" || entry.path().extension() == ".tmp";
    }
    EXPECT_EQ(num_files, err.empty() ? 1 : 0) << "what is refused leaves nothing behind";
    for (const auto& [name, text] : files_) EXPECT_EQ(text_of(folder_ / name), text) << name;
    const std::string said = out.substr(0, out.find("next: ")) + err;
    return said.substr(0, said.find_last_not_of('\n') + 1);
  }

 private:
  void write(const std::string& name, const std::string& text) {
    folder_.file(name, text);
    files_[name] = text;
    if (name.ends_with(".csv") && std::ranges::find(recordings_, name) == recordings_.end()) {
      recordings_.push_back(name);
    }
  }

  void read(const std::string& line, const std::string& base) {
    const std::size_t blank = line.find(' ');
    const std::string name = line.substr(0, blank);
    if (name == "$") {
      command_ = line.substr(2);
    } else if (line.starts_with("--")) {
      options_ += " " + line;
    } else if (name == "lab") {
      const Lab lab(line.substr(3));
      write("a.csv", lab.csv(true));
      write("b.csv", lab.csv(false));
    } else if (line.substr(name.size()).starts_with(" =") && line[blank + 2] != '>') {
      const std::string text = with_all(line.substr(std::min(blank + 3, line.size())), "\\n", "\n");
      write(name, with_all(text, "\\t", "\t"));
    } else if (name.ends_with(':')) {
      const std::string edit = line.substr(blank + 1);
      write(name.substr(0, name.size() - 1), edit == "as it is" ? base : edited(base, edit));
    } else if (line != "as it is") {
      write("a.csv", edited(text_of(folder_ / "a.csv"), line));
    }
  }

  std::string usual_command() const {
    return join(recordings_, " ") + " --simulator pendulum -o r.h5" + options_;
  }

  TempFolder folder_;
  std::filesystem::path before_;
  std::map<std::string, std::string> files_;
  std::vector<std::string> recordings_;
  std::string command_, options_;
};

TEST(Golden, Import) {
  expect_golden("import", [](const GoldenCase& given) { return Import(given).said(); });
}

}  // namespace
}  // namespace npdr::pipeline
