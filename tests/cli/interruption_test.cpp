#include <memory>
#include <random>

#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

class Interruption : public CommandTest {
 protected:
  void SetUp() override { prepare(small_study()); }

  void prepare(const std::string& study) {
    std::ofstream(folder_.path() / "small.toml") << study;
    const Outcome whole = npdr({"run", "small.toml", "--work", "whole"});
    ASSERT_EQ(whole.status, 0) << whole.err;
    reference_ = digests(folder_.path() / "whole" / "small");
  }

  // Starts the study again and again and finishes it. By turns, `signal` ends a run while it makes
  // something, and when it has made something more.
  void interrupt_and_finish(int signal, const std::string& work) {
    const std::vector<std::string> words = {"npdr", "run", "small.toml", "--work", work};
    const std::filesystem::path cache = folder_.path() / work / ".cache";
    const auto num_complete = [&] { return files_ending(cache, ".h5").size(); };
    int num_interrupted = 0;
    for (int i = 0; i < 12; ++i) {
      const std::size_t before = num_complete();
      const Program program(folder_.path(), words);
      if (i % 2 == 0) {
        begins_to_make(program, cache);
      } else {
        comes_true([&] { return program.has_ended() || num_complete() > before; });
      }
      program.send(signal);
      const int status = program.wait().status;
      const int interrupted = signal == SIGKILL ? 128 + SIGKILL : 75;
      EXPECT_TRUE(status == 0 || status == interrupted) << status;
      num_interrupted += status == interrupted ? 1 : 0;
    }
    EXPECT_GE(num_interrupted, 3);
    const Outcome last = run(folder_.path(), words);
    EXPECT_EQ(last.status, 0) << last.err;
    EXPECT_EQ(digests(folder_.path() / work / "small"), reference_);
  }

  std::map<std::string, std::string> reference_;
};

TEST_F(Interruption, KilledRunsGoOnWithTheSameBits) { interrupt_and_finish(SIGKILL, "killed"); }

TEST_F(Interruption, KilledMinigolfGoesOnWithTheSameBits) {
  std::filesystem::remove_all(folder_.path() / "whole");
  prepare(small_minigolf_study());
  interrupt_and_finish(SIGKILL, "golf");
}

TEST_F(Interruption, StoppedRunsGoOnWithTheSameBits) { interrupt_and_finish(SIGTERM, "stopped"); }

// Each run ends after an epoch or two, so all kinds of networks that are pooled go on from a
// checkpoint.
TEST_F(Interruption, StoppedPoolsGoOnWithTheSameBits) {
  std::filesystem::remove_all(folder_.path() / "whole");
  prepare(pendulum_study("small")
              .with("study", {"seeds = [1]"})
              .method("Pool", {"num_simulations = 200", "embedding = { downsample = 20 }",
                               "density_estimator = { num_networks = 2, hidden_features = 8 }",
                               "training = { max_epochs = 10 }"}));
  const std::vector<std::string> words = {"npdr", "run", "small.toml", "--work", "pool"};
  int num_interrupted = 0;
  for (int i = 0; i < 40; ++i) {
    const Program program(folder_.path(), words);
    begins_to_make(program, folder_.path() / "pool/.cache/infer");
    program.send(SIGTERM);
    const Outcome outcome = program.wait();
    EXPECT_TRUE(outcome.status == 0 || outcome.status == 75) << outcome.err;
    if (outcome.status != 75) break;
    ++num_interrupted;
  }
  EXPECT_GE(num_interrupted, 2) << "on a machine that is busy a run may get far";
  EXPECT_EQ(run(folder_.path(), words).status, 0);
  EXPECT_EQ(digests(folder_.path() / "pool" / "small"), reference_);
}

TEST_F(Interruption, StoppedDiagnosesGoOnWithTheSameBits) {
  std::filesystem::remove_all(folder_.path() / "whole");
  prepare(pendulum_study("small")
              .with("study", {"seeds = [1]"})
              .with("observation_noise", {"scale = 0.1"})
              .with("diagnose",
                    {"checks = [\"sbc\", \"tarp\"]", "num_simulations = 100", "num_samples = 50"})
              .method("Pool", {"num_simulations = 200", "embedding = { downsample = 20 }",
                               "density_estimator = { num_networks = 2, hidden_features = 8 }",
                               "training = { max_epochs = 10 }"}));
  std::vector<std::string> words = {"npdr", "run", "small.toml", "--work", "stopped"};
  ASSERT_EQ(npdr({"run", "small.toml", "--work", "stopped", "--until", "infer"}).status, 0);
  const Program program(folder_.path(), words);
  begins_to_make(program, folder_.path() / "stopped/.cache/diagnose");
  program.send(SIGTERM);
  EXPECT_EQ(program.wait().status, 75) << "the diagnosis must take longer";
  words[1] = "status";
  const Outcome status = run(folder_.path(), words);
  EXPECT_TRUE(has(status.out, "checkpoint at simulation"));
  words[1] = "run";
  const auto cache = folder_.path() / "stopped/.cache/diagnose";
  const auto checkpoint = cache / *files_ending(cache, ".checkpoint.h5").begin();
  const std::string kept = text_of(checkpoint);
  std::ofstream(checkpoint) << "none";
  EXPECT_NE(run(folder_.path(), words).status, 0) << "it isn't looked at";
  std::ofstream(checkpoint) << kept;
  EXPECT_EQ(run(folder_.path(), words).status, 0);
  EXPECT_EQ(digests(folder_.path() / "stopped" / "small"), reference_);
  EXPECT_EQ(files_ending(folder_.path() / "stopped/.cache/diagnose", ".checkpoint.h5").size(), 0u);
}

TEST_F(Interruption, CtrlCStopsAtAnyInstant) {
  const std::vector<std::string> words = {"npdr", "run", "small.toml", "--work", "ctrl-c"};
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    for (const int signal : {SIGINT, SIGUSR1}) {
      const Program program(folder_.path(), words);
      program.ends_within(0.001 * static_cast<double>(random() % 300));
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

constexpr const char* kCheckpoint = "checkpoint at epoch";

// A training of the small study that ends only when it is told to.
class EndlessTraining : public SmallStudyTest {
 protected:
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
    EXPECT_TRUE(begins_to_make(*program, folder_.path() / "runs/.cache/infer", 2));
    return program;
  }

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
  // Stopped for longer than from one report of their progress to the next, they have some for the
  // dead parent at once.
  for (const pid_t child : children) kill(child, SIGSTOP);
  program->send(SIGKILL);
  EXPECT_EQ(program->wait().status, 128 + SIGKILL);
  const auto due = std::chrono::steady_clock::now() + std::chrono::milliseconds(100);
  EXPECT_TRUE(comes_true([&] { return std::chrono::steady_clock::now() > due; }));
  for (const pid_t child : children) kill(child, SIGCONT);
  EXPECT_TRUE(comes_true([&] { return num_checkpoints() == 2; }));
}

}  // namespace
}  // namespace npdr::pipeline
