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
    run_output_ = npdr(0, joined({"run", name}, more)).out;
  }
  static void TearDownTestSuite() { delete folder_; }

  static Outcome npdr(const std::vector<std::string>& words) {
    return run(folder_->path(), joined({"npdr"}, words));
  }
  static Outcome npdr(int status, const std::vector<std::string>& words,
                      const std::source_location& where = std::source_location::current()) {
    return with_status(status, npdr(words), where);
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
