#include "core/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "core/error.h"
#include "tests/temp_folder.h"

namespace npdr {
namespace {

class TemporaryFolders : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const char* const value = std::getenv("TMPDIR")) before_ = value;
  }
  void TearDown() override {
    ::unsetenv("TMP");
    before_.empty() ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", before_.c_str(), 1);
  }

  static std::string refusal() {
    return message_of<InputError>([] { const TemporaryFolder folder("npdr_x", "for a trial"); });
  }

 private:
  std::string before_;
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
