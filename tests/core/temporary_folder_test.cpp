#include "core/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

#include "core/error.h"
#include "tests/temp_folder.h"

namespace npdr {
namespace {

class TemporaryFolders : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* const variable : {"TMPDIR", "TMP"}) {
      if (const char* const value = std::getenv(variable)) before_[variable] = value;
    }
  }
  void TearDown() override {
    for (const std::string variable : {"TMPDIR", "TMP"}) {
      ::unsetenv(variable.c_str());
      if (before_.contains(variable)) ::setenv(variable.c_str(), before_[variable].c_str(), 1);
    }
  }

  static std::string refusal() {
    return message_of<InputError>([] { const TemporaryFolder folder("npdr_x", "for a trial"); });
  }

 private:
  std::map<std::string, std::string> before_;
};

TEST_F(TemporaryFolders, AreRemovedWithAllThatIsInThem) {
  const TempFolder parent;
  ::setenv("TMPDIR", parent.path().c_str(), 1);
  {
    const TemporaryFolder folder("npdr_x", "for a trial");
    EXPECT_EQ(folder.path().parent_path(), parent.path());
    std::ofstream(folder.path() / "file") << "text";
  }
  EXPECT_EQ(parent.size(), 0);
}

TEST_F(TemporaryFolders, NameTheVariableThatIsWrong) {
  ::setenv("TMP", "/nowhere/tmp", 1);
  ::setenv("TMPDIR", "/nowhere/tmpdir", 1);
  EXPECT_EQ(refusal(), "TMPDIR = '/nowhere/tmpdir', must be an existing folder: for a trial");
  ::unsetenv("TMPDIR");
  EXPECT_EQ(refusal(), "TMP = '/nowhere/tmp', must be an existing folder: for a trial");
}

}  // namespace
}  // namespace npdr
