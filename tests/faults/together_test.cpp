#include "tests/faults/fault_study.h"

namespace npdr::pipeline {
namespace {

class Together : public Faults {
 protected:
  void SetUp() override { std::filesystem::remove_all(folder_->work()); }

  static std::size_t num_complete() { return files_ending(folder_->cache(), ".h5").size(); }
};

// The first two at once, and a third when they have made something.
TEST_F(Together, ThreeRunsGiveTheSameBits) {
  const std::vector<std::string> words = FaultFolder::npdr_words({"run", "--jobs", "1"});
  std::vector<std::unique_ptr<Program>> programs;
  for (int i = 0; i < 2; ++i) programs.push_back(start(words, i));
  EXPECT_TRUE(comes_true([&] { return num_complete() > 0; }));
  programs.push_back(start(words, 2));
  for (const auto& program : programs) with_status(0, program->wait());
  expect_same_results();
}

TEST_F(Together, ARunBesideTheStagesOwnExecutablesGivesTheSameBits) {
  const auto whole = start(FaultFolder::npdr_words({"run"}), 0);
  for (int round = 0; round < 2; ++round) {
    for (const std::string program : {"propose", "simulate", "infer", "evaluate", "diagnose"}) {
      const Outcome outcome = start({"npdr-" + program, "faults.toml"}, 1)->wait();
      // 2: what it needs isn't there yet.
      EXPECT_TRUE(outcome.status == 0 || outcome.status == 2) << program << ": " << outcome.err;
      EXPECT_TRUE(outcome.status == 0 || has(outcome.err, " needs '"));
    }
  }
  with_status(0, whole->wait());
  expect_same_results();
}

}  // namespace
}  // namespace npdr::pipeline
