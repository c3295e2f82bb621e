#include <fmt/format.h>

#include "tests/faults/fault_study.h"

namespace npdr::pipeline {
namespace {

class Together : public Faults {
 protected:
  void SetUp() override { std::filesystem::remove_all(folder_->work()); }

  // Starts all at once, or each when those before it have made something more.
  static void run_together(int num_runs, bool at_once) {
    std::vector<std::unique_ptr<Program>> programs;
    for (int i = 0; i < num_runs; ++i) {
      const std::size_t before = num_complete();
      programs.push_back(start(FaultFolder::words("npdr", {"run", "--jobs", "1"}), i));
      EXPECT_TRUE(at_once || comes_true([&] { return num_complete() > before; }));
    }
    int made = 0;
    for (const auto& program : programs) {
      const Outcome outcome = program->wait();
      EXPECT_EQ(outcome.status, 0) << outcome.err;
      made += made_by(outcome);
    }
    const auto needed = static_cast<int>(folder_->artefacts().size());
    fmt::print("{} runs {}: {} artefacts, {} made\n", num_runs,
               at_once ? "at once" : "one after the other", needed, made);
    expect_same_results(*folder_);
  }

 private:
  static std::size_t num_complete() { return files_ending(folder_->cache(), ".h5").size(); }

  // "faults: 26/26 [...": what it says at its end.
  static int made_by(const Outcome& outcome) {
    const std::size_t at = outcome.err.rfind("faults: ");
    return at == std::string::npos ? 0 : std::atoi(outcome.err.c_str() + at + 8);
  }
};

TEST_F(Together, TwoRunsAtOnceGiveTheSameBits) { run_together(2, true); }

TEST_F(Together, FourRunsOneAfterTheOtherGiveTheSameBits) { run_together(4, false); }

TEST_F(Together, ARunBesideTheStagesOwnExecutablesGivesTheSameBits) {
  const auto whole = start(FaultFolder::words("npdr", {"run"}), 0);
  std::vector<std::string> programs = {"propose", "simulate", "infer", "evaluate", "diagnose"};
  for (int round = 0; round < 2; ++round) {
    for (const std::string& program : programs) {
      const Outcome outcome = start(FaultFolder::words("npdr-" + program), 1)->wait();
      // 2: what it needs isn't there yet.
      EXPECT_TRUE(outcome.status == 0 || outcome.status == 2) << program << ": " << outcome.err;
      if (outcome.status == 2) {
        EXPECT_TRUE(has(outcome.err, " needs '"));
      }
    }
  }
  const Outcome outcome = whole->wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  expect_same_results(*folder_);
}

}  // namespace
}  // namespace npdr::pipeline
