// Tests of commands that use the results of a study, which each suite runs once.
#pragma once

#include "tests/cli/program.h"

namespace npdr::pipeline {

// A suite's SetUpTestSuite() calls run_study().
class StudyRun : public ::testing::Test {
 protected:
  static void run_study(const std::string& name, const std::string& text,
                        const std::vector<std::string>& more = {}) {
    folder_ = new TempFolder;
    std::ofstream(file(name)) << text;
    std::vector<std::string> words = {"run", name};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = npdr(words);
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

class SmallRun : public StudyRun {
 protected:
  static void SetUpTestSuite() { run_study("small.toml", small_study()); }
};

}  // namespace npdr::pipeline
