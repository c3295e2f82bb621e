#include "core/temporary_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <optional>
#include <string>

#include "core/error.h"
#include "tests/environment.h"
#include "tests/temp_folder.h"

namespace npdr {
namespace {

TEST(TemporaryFolders, AreRemovedWithAllThatIsInThem) {
  const TempFolder parent;
  const EnvironmentVariable variable("TMPDIR", parent.path());
  {
    const TemporaryFolder folder("npdr_x", "for a trial");
    EXPECT_EQ(folder.path().parent_path(), parent.path());
    std::ofstream(folder.path() / "file") << "text";
  }
  EXPECT_EQ(parent.size(), 0);
}

TEST(TemporaryFolders, NameTheVariableThatIsWrong) {
  const auto refusal = [](const std::optional<std::string>& tmpdir) {
    const EnvironmentVariable first("TMPDIR", tmpdir), second("TMP", "/nowhere/tmp");
    return message_of<InputError>([] { const TemporaryFolder folder("npdr_x", "for a trial"); });
  };
  EXPECT_EQ(refusal("/nowhere/tmpdir"),
            "TMPDIR = '/nowhere/tmpdir', must be an existing folder: for a trial");
  EXPECT_EQ(refusal({}), "TMP = '/nowhere/tmp', must be an existing folder: for a trial");
}

}  // namespace
}  // namespace npdr
