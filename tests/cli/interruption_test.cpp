#include <memory>
#include <random>

#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

// Of a study that is called "small".
class Interruption : public CommandTest {
 protected:
  void prepare(const StudyText& study) {
    folder_.file("small.toml", study);
    npdr(0, {"run", "small.toml", "--work", "whole"});
    reference_ = digests(folder_ / "whole/small");
  }

  std::vector<std::string> words() const { return {"npdr", "run", "small.toml", "--work", "work"}; }
  std::filesystem::path cache() const { return folder_ / "work/.cache"; }
  void expect_to_finish_with_the_same_bits() const {
    with_status(0, run(folder_.path(), words()));
    EXPECT_EQ(digests(folder_ / "work/small"), reference_);
  }

  std::map<std::string, std::string> reference_;
};

// By turns, runs are stopped while they make something, and when they have made something more.
TEST_F(Interruption, StoppedRunsGoOnWithTheSameBits) {
  prepare(small_study());
  const auto num_complete = [&] { return files_ending(cache(), ".h5").size(); };
  int num_interrupted = 0;
  for (int i = 0; i < 12; ++i) {
    const std::size_t before = num_complete();
    const Program program(folder_.path(), words());
    if (i % 2 == 0) {
      begins_to_make(program, cache());
    } else {
      comes_true([&] { return program.has_ended() || num_complete() > before; });
    }
    program.send(SIGTERM);
    const int status = program.wait().status;
    EXPECT_TRUE(status == 0 || status == 75) << status;
    num_interrupted += status == 75 ? 1 : 0;
  }
  EXPECT_GE(num_interrupted, 3);
  expect_to_finish_with_the_same_bits();
}

StudyText study_of_a_pool() {
  return pendulum_study("small")
      .with("study", {"seeds = [1]"})
      .method("Pool", {"num_simulations = 200", "embedding = { downsample = 20 }",
                       "density_estimator = { num_networks = 2, hidden_features = 8 }",
                       "training = { max_epochs = 10 }"});
}

// Each run ends after an epoch or two, so all kinds of networks that are pooled go on from a
// checkpoint.
TEST_F(Interruption, StoppedPoolsGoOnWithTheSameBits) {
  prepare(study_of_a_pool());
  int num_interrupted = 0;
  for (int i = 0; i < 40; ++i) {
    const Program program(folder_.path(), words());
    begins_to_make(program, cache() / "infer");
    program.send(SIGTERM);
    const Outcome outcome = program.wait();
    EXPECT_TRUE(outcome.status == 0 || outcome.status == 75) << outcome.err;
    if (outcome.status != 75) break;
    ++num_interrupted;
  }
  EXPECT_GE(num_interrupted, 2) << "on a machine that is busy a run may get far";
  expect_to_finish_with_the_same_bits();
}

TEST_F(Interruption, StoppedDiagnosesGoOnWithTheSameBits) {
  prepare(study_of_a_pool()
              .with("observation_noise", {"scale = 0.1"})
              .with("diagnose",
                    {"checks = [\"sbc\", \"tarp\"]", "num_simulations = 100", "num_samples = 50"}));
  with_status(0, run(folder_.path(), joined(words(), {"--until", "infer"})));
  const Program program(folder_.path(), words());
  begins_to_make(program, cache() / "diagnose");
  program.send(SIGTERM);
  EXPECT_EQ(program.wait().status, 75) << "the diagnosis must take longer";
  EXPECT_TRUE(
      has(npdr({"status", "small.toml", "--work", "work"}).out, "checkpoint at simulation"));
  const auto checkpoints = [&] { return files_ending(cache() / "diagnose", ".checkpoint.h5"); };
  const auto checkpoint = cache() / "diagnose" / *checkpoints().begin();
  const std::string kept = text_of(checkpoint);
  std::ofstream(checkpoint) << "none";
  EXPECT_NE(run(folder_.path(), words()).status, 0) << "it isn't looked at";
  std::ofstream(checkpoint) << kept;
  expect_to_finish_with_the_same_bits();
  EXPECT_EQ(checkpoints().size(), 0u);
}

TEST_F(Interruption, CtrlCStopsAtAnyInstant) {
  prepare(small_study());
  std::mt19937 random(1);
  for (int i = 0; i < 12; ++i) {
    for (const int signal : {SIGINT, SIGUSR1}) {
      const Program program(folder_.path(), words());
      program.ends_within(0.001 * static_cast<double>(random() % 300));
      program.send_to_group(signal);
      const Outcome outcome = program.wait();
      // 128 + signal: it came before the program could listen.
      EXPECT_TRUE(outcome.status == 0 || outcome.status == 75 || outcome.status == 128 + signal)
          << outcome.status << " by " << signal << "\n"
          << outcome.err;
    }
    if (i % 4 == 3) std::filesystem::remove_all(folder_ / "work");
  }
  expect_to_finish_with_the_same_bits();
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
    return joined({"npdr", command, "small.toml", "--set", "method.training.max_epochs=1000000",
                   "--set", "method.training.stop_after_epochs=1000000"},
                  more);
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
