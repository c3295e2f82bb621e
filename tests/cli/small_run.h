// A small study that has been run, for tests of commands that use its results.
#pragma once

#include "tests/cli/program.h"

namespace npdr::pipeline {

// Each suite that derives from this runs the study once.
class SmallRun : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    std::ofstream(folder_->path() / "small.toml") << small_study();
    const Outcome outcome = npdr({"run", "small.toml"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    run_output_ = outcome.out;
  }
  static void TearDownTestSuite() { delete folder_; }

  static Outcome npdr(std::vector<std::string> words) {
    words.insert(words.begin(), "npdr");
    return run(folder_->path(), words);
  }
  static std::filesystem::path file(const std::string& name) { return folder_->path() / name; }

  inline static TempFolder* folder_ = nullptr;
  inline static std::string run_output_;
};

}  // namespace npdr::pipeline
