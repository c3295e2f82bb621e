#include "pipeline/sources/program_call.h"

#include <filesystem>

#include "core/error.h"
#include "tests/message_of.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

class FileHashesTest : public testing::Test {
 protected:
  FileHashesTest() { folder_.file("sim.sh", "echo 1"); }

  FileHashes read() const { return {{"sim.sh"}, folder_.path()}; }

  TempFolder folder_;
};

TEST_F(FileHashesTest, AreThoseOfTheBytes) {
  const auto before = read().by_name();
  ASSERT_TRUE(before.contains("sim.sh"));
  EXPECT_EQ(read().by_name(), before);
  folder_.file("sim.sh", "echo 2");
  EXPECT_NE(read().by_name(), before);
}

TEST_F(FileHashesTest, RefuseAFileThatWasEdited) {
  FileHashes files = read();
  EXPECT_NO_THROW(files.require_unchanged());
  folder_.file("sim.sh", "echo 10");
  EXPECT_TRUE(says(message_of<Error>([&] { files.require_unchanged(); }),
                   {(folder_ / "sim.sh").string(), "was edited", "run again"}));
  std::filesystem::remove(folder_ / "sim.sh");
  EXPECT_TRUE(says(message_of<Error>([&] { files.require_unchanged(); }),
                   {(folder_ / "sim.sh").string(), "is gone", "run again"}));
}

TEST_F(FileHashesTest, TakeTheSameBytesWrittenAgain) {
  FileHashes files = read();
  folder_.file("sim.sh", "echo 1");
  std::filesystem::last_write_time(
      folder_ / "sim.sh", std::filesystem::file_time_type::clock::now() + std::chrono::hours(1));
  EXPECT_NO_THROW(files.require_unchanged());
}

TEST_F(FileHashesTest, NameAFileThatIsNotThere) {
  EXPECT_THROW(FileHashes({"nothing.sh"}, folder_.path()), InputError);
}

}  // namespace
}  // namespace npdr::pipeline
