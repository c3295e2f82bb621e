#include "analysis/text_file.h"

#include <gtest/gtest.h>

#include <iterator>

#include "core/error.h"
#include "tests/analysis/scratch_folder.h"

namespace npdr::analysis {
namespace {

TEST(TextFile, ReadsWhatItWroteAndLeavesNothingElse) {
  const ScratchFolder folder;
  const auto path = folder.path() / "new" / "file.txt";
  write_text_file(path, "first");
  const std::string text("second\0\n", 8);
  write_text_file(path, text);
  EXPECT_EQ(read_text_file(path), text);
  const auto files = std::filesystem::directory_iterator(path.parent_path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
}

std::string message_of(void (*action)(const std::filesystem::path&),
                       const std::filesystem::path& path) {
  try {
    action(path);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(TextFile, SaysWhichFileCannotBeReadOrWritten) {
  const ScratchFolder folder;
  const auto missing = folder.path() / "missing";
  EXPECT_EQ(message_of([](const auto& path) { read_text_file(path); }, missing),
            missing.string() + ": can't be read: No such file or directory");
  write_text_file(folder.path() / "file", "");
  const auto below_file = folder.path() / "file" / "below";
  EXPECT_NE(message_of([](const auto& path) { write_text_file(path, ""); }, below_file)
                .find((folder.path() / "file").string()),
            std::string::npos);
  // A folder can't be replaced by a file, and the temporary must not stay.
  const auto occupied = folder.path() / "occupied";
  std::filesystem::create_directories(occupied / "child");
  EXPECT_NE(message_of([](const auto& path) { write_text_file(path, ""); }, occupied)
                .find("can't be replaced"),
            std::string::npos);
  const auto files = std::filesystem::directory_iterator(folder.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 2);
}

}  // namespace
}  // namespace npdr::analysis
