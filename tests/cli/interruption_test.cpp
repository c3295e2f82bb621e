#include <memory>
#include <random>

#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

using std::chrono::milliseconds;

class Interruption : public ::testing::Test {
 protected:
  void SetUp() override { prepare(small_study()); }

  void prepare(const std::string& study) {
    std::ofstream(folder_.path() / "small.toml") << study;
    const Outcome whole = run(folder_.path(), {"npdr", "run", "small.toml", "--work", "whole"});
    ASSERT_EQ(whole.status, 0) << whole.err;
    reference_ = digests(folder_.path() / "whole" / "small");
  }

  // Starts the study again and again, ends each run with `signal` a little later than the one
  // before, and finishes it.
  void interrupt_and_finish(int signal, const std::string& work) {
    const std::vector<std::string> words = {"npdr", "run", "small.toml", "--work", work};
    for (int delay = 20; delay <= 400; delay += 38) {
      const Program program(folder_.path(), words);
      std::this_thread::sleep_for(milliseconds(delay));
      program.send(signal);
      const int status = program.wait().status;
      // 128 + signal: it came before the program could listen.
      EXPECT_TRUE(status == 0 || status == 75 || status == 128 + signal) << status;
    }
    const Outcome last = run(folder_.path(), words);
    EXPECT_EQ(last.status, 0) << last.err;
    EXPECT_EQ(digests(folder_.path() / work / "small"), reference_);
  }

  TempFolder folder_;
  std::map<std::string, std::string> reference_;
};

TEST_F(Interruption, KilledRunsGoOnWithTheSameBits) { interrupt_and_finish(SIGKILL, "killed"); }

TEST_F(Interruption, KilledMinigolfGoesOnWithTheSameBits) {
  std::filesystem::remove_all(folder_.path() / "whole");
  prepare(small_minigolf_study());
  interrupt_and_finish(SIGKILL, "golf");
}

TEST_F(Interruption, StoppedRunsGoOnWithTheSameBits) { interrupt_and_finish(SIGTERM, "stopped"); }

TEST_F(Interruption, CtrlCStopsAtAnyInstant) {
  const std::vector<std::string> words = {"npdr", "run", "small.toml", "--work", "ctrl-c"};
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    for (const int signal : {SIGINT, SIGUSR1}) {
      const Program program(folder_.path(), words);
      std::this_thread::sleep_for(milliseconds(random() % 300));
      program.send_to_group(signal);
      const Outcome outcome = program.wait();
      // 128 + signal: it came before the program could listen.
      EXPECT_TRUE(outcome.status == 0 || outcome.status == 75 || outcome.status == 128 + signal)
          << outcome.status << " by " << signal << "\n"
          << outcome.err;
    }
    if (i % 5 == 4) std::filesystem::remove_all(folder_.path() / "ctrl-c");
  }
  EXPECT_EQ(run(folder_.path(), words).status, 0);
  EXPECT_EQ(digests(folder_.path() / "ctrl-c" / "small"), reference_);
}

// Whether `condition` holds within ten seconds.
template <class Condition>
bool comes_true(const Condition& condition) {
  for (int i = 0; i < 100 && !condition(); ++i) std::this_thread::sleep_for(milliseconds(100));
  return condition();
}

constexpr const char* kCheckpoint = "checkpoint at epoch";

// A training of the small study that ends only when it is told to.
class EndlessTraining : public ::testing::Test {
 protected:
  void SetUp() override { std::ofstream(folder_.path() / "small.toml") << small_study(); }

  // How many trainings have a checkpoint.
  int num_checkpoints() const {
    const std::string status = run(folder_.path(), words("status", {})).out;
    int count = 0;
    for (std::size_t at = status.find(kCheckpoint); at != std::string::npos;
         at = status.find(kCheckpoint, at + 1)) {
      ++count;
    }
    return count;
  }

  // Running, with its trainings under way.
  std::unique_ptr<Program> started() const {
    EXPECT_EQ(run(folder_.path(), words("run", {"--until", "simulate"})).status, 0);
    auto program = std::make_unique<Program>(folder_.path(),
                                             words("run", {"--until", "infer", "--jobs", "2"}));
    std::this_thread::sleep_for(milliseconds(1500));
    return program;
  }

  TempFolder folder_;

 private:
  static std::vector<std::string> words(const std::string& command,
                                        const std::vector<std::string>& more) {
    std::vector<std::string> words = {"npdr",
                                      command,
                                      "small.toml",
                                      "--set",
                                      "method.training.max_epochs=1000000",
                                      "--set",
                                      "method.training.stop_after_epochs=1000000"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
};

TEST_F(EndlessTraining, StopsAtACheckpointAndGoesOnFromIt) {
  for (const int signal : {SIGTERM, SIGHUP}) {
    const auto program = started();
    program->send(signal);
    EXPECT_EQ(program->wait().status, 75) << signal;
    EXPECT_EQ(num_checkpoints(), 2);
    std::filesystem::remove_all(folder_.path() / "runs");
  }
}

TEST_F(EndlessTraining, ARequestIsPassedOnAfterAChildHasStoppedByItself) {
  const auto program = started();
  const auto children = program->children();
  ASSERT_EQ(children.size(), 2u);
  kill(children.front(), SIGTERM);
  EXPECT_TRUE(comes_true([&] { return program->children().size() == 1; }));
  program->send(SIGTERM);
  if (!comes_true([&] { return program->children().empty(); })) program->send(SIGKILL);
  EXPECT_EQ(program->wait().status, 75);
}

TEST_F(EndlessTraining, SavesItsWorkWhenItsParentIsKilled) {
  const auto program = started();
  const auto children = program->children();
  ASSERT_EQ(children.size(), 2u);
  // Stopped for a while, they have progress to report to the dead parent at once.
  for (const pid_t child : children) kill(child, SIGSTOP);
  program->send(SIGKILL);
  EXPECT_EQ(program->wait().status, 128 + SIGKILL);
  std::this_thread::sleep_for(milliseconds(200));
  for (const pid_t child : children) kill(child, SIGCONT);
  EXPECT_TRUE(comes_true([&] { return num_checkpoints() == 2; }));
}

}  // namespace
}  // namespace npdr::pipeline
