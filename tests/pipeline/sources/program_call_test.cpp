#include "pipeline/sources/program_call.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <filesystem>

#include "core/error.h"
#include "tests/message_of.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

TEST(CommandText, PlaceholdersBecomeQuotedPaths) {
  EXPECT_EQ(filled_command("sim --in={theta} --out={x}", "/t/a.csv", "/t/b c.csv"),
            "sim --in=/t/a.csv --out='/t/b c.csv'");
  EXPECT_EQ(filled_command("sim {x} < {theta}; test -s {x}", "/a", "/b"),
            "sim /b < /a; test -s /b");
}

TEST(CommandText, FilesWithoutAPlaceholderAreAppended) {
  EXPECT_EQ(filled_command("python3 sim.py\n", "/a", "/b"), "python3 sim.py /a /b");
  EXPECT_EQ(filled_command("sim {theta} -o", "/a", "/b"), "sim /a -o /b");
  EXPECT_EQ(filled_command("sim {x}", "/a", "/b"), "sim /b /a");
}

TEST(CommandText, FilesElsewhereAreFoundButForInterpreters) {
  const TempFolder folder;
  for (const char* path : {"study", "env/bin", "sim"}) {
    std::filesystem::create_directories(folder / path);
  }
  folder.file("sim/run.py", "print()");
  folder.file("env/bin/python3", "");
  folder.file("study/own.py", "print()");
  std::filesystem::create_directory_symlink(folder / "study", folder / "link");
  using Words = std::vector<std::string>;
  const std::string absolute = folder / "sim/run.py", linked = folder / "link/own.py";
  EXPECT_EQ(named_paths("../env/bin/python3 ../sim/run.py", folder.path() / "study"),
            Words{"../sim/run.py"});
  EXPECT_EQ(named_paths("/bin/sh " + absolute, folder.path() / "study"), Words{absolute});
  EXPECT_EQ(named_paths("sh " + linked, folder.path() / "study"), Words{linked});
  EXPECT_EQ(named_paths("sh ../sim/run.py > own.py 2>> own.py", folder.path() / "study"),
            Words{"../sim/run.py"})
      << "what is written is no source";
  EXPECT_EQ(named_paths(". /etc/passwd; sh own.py", folder.path() / "study"), Words{"own.py"});
}

TEST(CommandText, ProgramsInABinOfTheFolderAreTheSimulators) {
  const TempFolder folder;
  for (const char* path : {"study/bin", "build"}) {
    std::filesystem::create_directories(folder / path);
  }
  folder.file("build/mysim", "");
  std::filesystem::create_symlink("../../build/mysim", folder / "study/bin/mysim");
  EXPECT_EQ(named_paths("bin/mysim {theta} {x}", folder.path() / "study"),
            std::vector<std::string>{"bin/mysim"});
}

TEST(CommandText, FilesOfTheFolderAreFoundInItsWords) {
  const TempFolder folder;
  folder.file("sim.py", "print()");
  folder.file("my config.json", "{}");
  folder.file("other.txt", "");
  const auto files =
      named_paths("OMP=1 python3 ./sim.py --config='my config.json' /bin/sh ../x nothing {theta}",
                  folder.path());
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[0], "./sim.py");
  EXPECT_EQ(files[1], "my config.json");
  EXPECT_EQ(named_paths("sh -c 'python3 sim.py $0 $1' {theta} {x}", folder.path()),
            std::vector<std::string>{"sim.py"});
  EXPECT_EQ(named_paths("python3 my\\ config.json \\", folder.path()),
            std::vector<std::string>{"my config.json"});
  folder.file("config.json", "{}");
  EXPECT_EQ(named_paths("sim 'my config.json'", folder.path()),
            std::vector<std::string>{"my config.json"})
      << "not that of its last word";
  folder.file("a\\b.py", "");
  EXPECT_EQ(named_paths("python3 \"a\\b.py\"", folder.path()), std::vector<std::string>{"a\\b.py"});
  EXPECT_EQ(named_paths(folder / "sim.py", folder.path()).size(), 1u) << "an absolute path into it";
}

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
