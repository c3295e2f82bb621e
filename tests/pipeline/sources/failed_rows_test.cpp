#include "pipeline/sources/program_call.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include "core/error.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

using Rows = std::map<Index, std::string>;

class FailedRows : public ::testing::Test {
 protected:
  Rows read(const std::string& text) {
    folder_.file("failed", text);
    return read_failed_rows(folder_ / "failed", 12);
  }

  std::string problem_of(const std::string& text) {
    return message_of<InputError>([&] { read(text); });
  }

  std::string problem_of_path() {
    return message_of<InputError>([&] { read_failed_rows(folder_ / "failed", 12); });
  }

  TempFolder folder_;
};

TEST_F(FailedRows, NoFileNamesNone) {
  EXPECT_EQ(read_failed_rows(folder_ / "failed", 12), Rows());
  EXPECT_EQ(read(""), Rows());
}

TEST_F(FailedRows, ALineNamesARowAndWhy) {
  EXPECT_EQ(read("3 too stiff\n11\ttoo  soft \r\n3 no\n"),
            (Rows{{3, "too stiff"}, {11, "too  soft"}}));
  const std::string unknown = "it failed, and NPDR_FAILED doesn't say why";
  EXPECT_EQ(read("3\n4 \n5\r\n"), (Rows{{3, unknown}, {4, unknown}, {5, unknown}}));
  EXPECT_EQ(read("1 " + std::string(5000, 'a') + "\n").at(1).size(), 999u);
}

TEST_F(FailedRows, ALastLineWithoutAnEndHasItsWholeNumber) {
  EXPECT_EQ(read("3 too st"), (Rows{{3, "too st"}}));
  EXPECT_EQ(problem_of("3 why\n1"),
            "NPDR_FAILED has in line 2 '1', must have a row's number, 0 to 11, a blank, why it "
            "failed, and the line's end");
}

TEST_F(FailedRows, OtherLinesAreErrors) {
  for (const std::string line : {"12 why", "-1 why", "all", "", " 3 why", "3: why", "3.0 why",
                                 "99999999999999999999 why", "\xff\x01"}) {
    EXPECT_TRUE(problem_of("0 why\n" + line + "\n").starts_with("NPDR_FAILED has in line 2 '"))
        << problem_of("0 why\n" + line + "\n");
  }
}

TEST_F(FailedRows, WhatIsNoFileIsAnError) {
  const std::filesystem::path path = folder_ / "failed";
  std::filesystem::create_directory(path);
  EXPECT_EQ(problem_of_path(), "NPDR_FAILED must be a file");
  std::filesystem::remove(path);
  std::filesystem::create_symlink("failed", path);
  EXPECT_EQ(problem_of_path(), "NPDR_FAILED must be a file");
  std::filesystem::remove(path);
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_EQ(problem_of_path(), "NPDR_FAILED must be a file");
}

TEST_F(FailedRows, AFileThatIsTooLargeIsNotRead) {
  folder_.file("failed", "0 why\n");
  std::filesystem::resize_file(folder_ / "failed", std::uintmax_t{1} << 40);
  EXPECT_EQ(problem_of_path(),
            "NPDR_FAILED has 1099511627776 bytes, must have 16777216 or less: a line for each row "
            "that failed");
}

}  // namespace
}  // namespace npdr::pipeline
