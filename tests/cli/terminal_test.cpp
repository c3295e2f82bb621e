/// What people see of a run on a terminal.
#include <sys/ioctl.h>

#include <array>
#include <regex>
#include <sstream>
#include <thread>

#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

// A terminal of a size, and all that is written to it.
class Terminal {
 public:
  Terminal(unsigned short columns, unsigned short rows)
      : master_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    grantpt(master_);
    unlockpt(master_);
    name_ = ptsname(master_);
    const winsize size = {rows, columns, 0, 0};
    ioctl(master_, TIOCSWINSZ, &size);
    own_ = open(name_.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC);
    reader_ = std::thread([this] {
      std::array<char, 1024> chunk;
      for (;;) {
        const ssize_t count = ::read(master_, chunk.data(), chunk.size());
        if (count <= 0) break;
        text_.append(chunk.data(), static_cast<std::size_t>(count));
      }
    });
  }
  ~Terminal() { close(master_); }

  const std::string& name() const { return name_; }

  // Once nobody else writes to it any more.
  std::string text() {
    close(own_);
    reader_.join();
    return text_;
  }

 private:
  int master_, own_ = -1;
  std::string name_, text_;
  std::thread reader_;
};

TEST(Terminal, NoLineOfARunIsWiderThanItIs) {
  const TempFolder folder;
  folder.file("s.toml", small_study());
  Terminal terminal(60, 24);
  const Outcome outcome = run(folder.path(), {"npdr", "run", "s.toml"}, {.err = terminal.name()});
  EXPECT_EQ(outcome.status, 0);
  const std::string shown =
      std::regex_replace(terminal.text(), std::regex("\x1b\\[[0-9]*[A-Z]"), "");
  std::size_t num_bars = 0, num_jobs = 0;
  std::string line;
  for (const char c : shown) {
    if (c != '\r' && c != '\n') {
      line += c;
      continue;
    }
    if (line.starts_with("small [")) {
      ++num_bars;
      EXPECT_LT(line.size(), 60u) << line;
    }
    if (line.starts_with("  ")) ++num_jobs;
    line.clear();
  }
  EXPECT_GT(num_bars, 0u) << shown;
  EXPECT_GT(num_jobs, 0u) << shown;
  EXPECT_TRUE(has(shown, "small: 100 %, 15 of 15 artefacts"));
}

// The call that is repeated takes so long that the display comes by several times.
TEST(Terminal, ShowsWhyACallOfTheSimulatorFailedWhileItIsRepeated) {
  const TempFolder folder;
  std::filesystem::copy(std::filesystem::path(NPDR_SOURCE_DIR) / "experiments/external",
                        folder.path());
  Terminal terminal(150, 24);
  const std::string command =
      "simulator.command=\"if ! test -e failed; then touch failed; exit 9; fi; sleep 1; "
      "sh linear_gaussian.sh {theta} {x}\"";
  const Outcome outcome = run(folder.path(),
                              {"npdr", "run", "crashing.toml", "--until", "simulate", "--set",
                               command, "--set", "simulator.retries=1", "--set",
                               "simulator.parallel_calls=1", "--set", "method.num_simulations=64"},
                              {.err = terminal.name()});
  EXPECT_EQ(outcome.status, 0);
  const std::string shown = terminal.text();
  EXPECT_TRUE(has(shown, "64 of 64 rows failed: exit status 9"));
}

// The longest label has 36 characters: with keys its row has 80.
TEST(Terminal, NoLineOfStatusIsWiderThanItIs) {
  const TempFolder folder;
  folder.file("s.toml", small_study());
  const Outcome whole = run(folder.path(), {"npdr", "status", "s.toml"});
  EXPECT_TRUE(has(whole.out, "  key\n"));
  for (const unsigned short columns : std::to_array<unsigned short>({79, 80})) {
    Terminal terminal(columns, 24);
    EXPECT_EQ(run(folder.path(), {"npdr", "status", "s.toml"}, {.out = terminal.name()}).status, 0);
    std::istringstream shown(terminal.text());
    std::string line;
    std::size_t longest = 0;
    bool has_keys = false;
    while (std::getline(shown, line)) {
      longest = std::max(longest, line.size() - 1);  // without the carriage return
      has_keys = has_keys || line.ends_with("  key\r");
    }
    EXPECT_EQ(longest, columns == 79 ? 70u : 80u);
    EXPECT_EQ(has_keys, columns == 80);
  }
}

}  // namespace
}  // namespace npdr::pipeline
