#include "analysis/text_file.h"

#include <gtest/gtest.h>

#include <iterator>

#include "core/error.h"
#include "tests/message_of.h"
#include "tests/temp_folder.h"

namespace npdr::analysis {
namespace {

TEST(TextFile, ReadsWhatItWroteAndLeavesNothingElse) {
  const TempFolder folder;
  const auto path = folder.path() / "new" / "file.txt";
  write_text_file(path, "first");
  const std::string text("second\0\n", 8);
  write_text_file(path, text);
  EXPECT_EQ(read_text_file(path), text);
  const auto files = std::filesystem::directory_iterator(path.parent_path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
}

TEST(TextFile, SaysWhichFileCannotBeReadOrWritten) {
  const TempFolder folder;
  const auto missing = folder.path() / "missing";
  EXPECT_EQ(message_of<Error>([&] { read_text_file(missing); }),
            missing.string() + ": can't be read: No such file or directory");
  write_text_file(folder.path() / "file", "");
  const auto below_file = folder.path() / "file" / "below";
  EXPECT_NE(message_of<Error>([&] {
              write_text_file(below_file, "");
            }).find((folder.path() / "file").string()),
            std::string::npos);
  // A folder can't be replaced by a file, and the temporary must not stay.
  const auto occupied = folder.path() / "occupied";
  std::filesystem::create_directories(occupied / "child");
  EXPECT_NE(message_of<Error>([&] { write_text_file(occupied, ""); }).find("can't be replaced"),
            std::string::npos);
  const auto files = std::filesystem::directory_iterator(folder.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 2);
}

}  // namespace
}  // namespace npdr::analysis
