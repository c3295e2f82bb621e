#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

using std::chrono::milliseconds;

class Interruption : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_.path() / "small.toml") << small_study();
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

TEST_F(Interruption, StoppedRunsGoOnWithTheSameBits) { interrupt_and_finish(SIGTERM, "stopped"); }

TEST_F(Interruption, TrainingStopsAtACheckpointAndGoesOnFromIt) {
  const std::vector<std::string> slow = {"--set", "method.training.max_epochs=1000000", "--set",
                                         "method.training.stop_after_epochs=1000000"};
  std::vector<std::string> words = {"npdr", "run", "small.toml", "--until", "infer"};
  words.insert(words.end(), slow.begin(), slow.end());
  const Program program(folder_.path(), words);
  std::this_thread::sleep_for(milliseconds(1500));
  program.send(SIGTERM);
  EXPECT_EQ(program.wait().status, 75);
  std::vector<std::string> status = {"npdr", "status", "small.toml"};
  status.insert(status.end(), slow.begin(), slow.end());
  EXPECT_NE(run(folder_.path(), status).out.find("checkpoint at epoch"), std::string::npos);
}

}  // namespace
}  // namespace npdr::pipeline
