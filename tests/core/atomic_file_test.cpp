#include "core/atomic_file.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <vector>

#include "core/error.h"
#include "tests/file_size_limit.h"
#include "tests/message_of.h"
#include "tests/temp_folder.h"

namespace npdr {
namespace {

TEST(AtomicFile, HasItsNameOnlyAfterCommit) {
  const TempFolder folder;
  {
    AtomicFile file(folder / "a.txt");
    std::ofstream(file.temporary()) << "new";
    EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
    EXPECT_EQ(file.temporary().parent_path(), folder.path());
    file.commit();
  }
  EXPECT_EQ(text_of(folder / "a.txt"), "new");
  EXPECT_EQ(folder.size(), 1);
}

TEST(AtomicFile, AnAbandonedWriteLeavesTheOldFileAndNothingElse) {
  const TempFolder folder;
  folder.file("a.txt", "old");
  EXPECT_THROW(
      {
        AtomicFile file(folder / "a.txt");
        std::ofstream(file.temporary()) << "half of the n";
        throw Error("the writer failed");
      },
      Error);
  EXPECT_EQ(text_of(folder / "a.txt"), "old");
  EXPECT_EQ(folder.size(), 1);
}

TEST(AtomicFile, AFailedWriteLeavesTheOldFileAndSaysWhatToDo) {
  const TempFolder folder;
  folder.file("a.txt", "old");
  const FileSizeLimit limit(1000);
  EXPECT_TRUE(says(message_of<Error>(
                       [&] { write_text_file(folder / "a.txt", std::string(5000, 'x')); }, &folder),
                   {"a.txt: can't be written: File too large",
                    "raise the limit on the size of a file (ulimit -f)"}));
  EXPECT_EQ(text_of(folder / "a.txt"), "old");
  EXPECT_EQ(folder.size(), 1);
}

TEST(AtomicFile, MakesTheFolder) {
  const TempFolder folder;
  write_text_file(folder / "x/y/a.txt", "text");
  EXPECT_EQ(text_of(folder / "x/y/a.txt"), "text");
}

TEST(AtomicFile, ReadsBackWhatItWroteAndSaysWhatCantBeRead) {
  const TempFolder folder;
  const std::string text("bytes\0\n", 7);
  write_text_file(folder / "a.txt", text);
  EXPECT_EQ(read_text_file(folder / "a.txt"), text);
  EXPECT_EQ(message_of<Error>([&] { read_text_file(folder / "b.txt"); }, &folder),
            "b.txt: can't be read: No such file or directory");
  EXPECT_EQ(message_of<Error>([&] { read_text_file(folder.path()); }),
            folder.path().string() + ": can't be read: Is a directory");
}

TEST(AtomicFile, CantReplaceAFolderAndLeavesNothingBehind) {
  const TempFolder folder;
  std::filesystem::create_directories(folder / "a" / "child");
  EXPECT_THROW(write_text_file(folder / "a", "text"), Error);
  EXPECT_EQ(folder.size(), 1);
}

// As root, "-o /dev/null" would leave the machine without one.
TEST(AtomicFile, TakesNoNameOfADeviceOrPipe) {
  const TempFolder folder;
  const std::filesystem::path pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(message_of<InputError>([&] { write_text_file(pipe, "new"); }, &folder),
            "pipe: is a device, pipe or socket, must be a file or a new name");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_EQ(folder.size(), 1);
  std::filesystem::create_symlink(pipe, folder / "link");  // as /dev/stdout is
  EXPECT_THROW(write_text_file(folder / "link", "new"), InputError);
}

TEST(AtomicFile, TwoWritersOfOneFileDontMeet) {
  const TempFolder folder;
  AtomicFile first(folder / "a.txt"), second(folder / "a.txt");
  std::ofstream(first.temporary()) << "first";
  std::ofstream(second.temporary()) << "second";
  first.commit();
  EXPECT_EQ(text_of(folder / "a.txt"), "first");
  second.commit();
  EXPECT_EQ(text_of(folder / "a.txt"), "second");
}

// In a folder that others may write to, too.
TEST(AtomicFile, FollowsNoLinkThatSomebodyHasPutInTheWay) {
  const TempFolder folder;
  folder.file("victim", "theirs");
  for (int number = 0; number < 1000; ++number) {
    std::filesystem::create_symlink(
        "victim", folder / fmt::format(".a.txt.{}.{}.{}.tmp", process_space(), ::getpid(), number));
  }
  write_text_file(folder / "a.txt", "ours");
  EXPECT_EQ(text_of(folder / "victim"), "theirs");
  EXPECT_EQ(text_of(folder / "a.txt"), "ours");
  EXPECT_NE(temporary_name(folder / "a.txt"), temporary_name(folder / "a.txt"));
}

TEST(AtomicFile, SaysWhenTheFolderIsAFile) {
  const TempFolder folder;
  folder.file("f", "");
  EXPECT_EQ(message_of<Error>([&] { AtomicFile file(folder / "f/a.txt"); }, &folder),
            "f: can't be made a folder: Not a directory");
}

TEST(AtomicFile, SaysWhenTheFolderCantBeWrittenTo) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const TempFolder folder;
  std::filesystem::permissions(
      folder.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_TRUE(says(message_of<Error>([&] { AtomicFile file(folder / "a.txt"); }, &folder),
                   {"a.txt: can't be written: Permission denied",
                    "make the folder writable or choose another one"}));
}

// The id of a process that no longer runs.
pid_t dead_process() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  return child;
}

TEST(AtomicFile, RemovesWhatDeadProcessesOfThisHostLeftBehindAndNothingElse) {
  const TempFolder folder;
  const std::string stale = fmt::format(".a.h5.{}.{}.0.tmp", process_space(), dead_process());
  const std::vector<std::string> kept = {
      fmt::format(".a.h5.{}.{}.0.tmp", process_space(), ::getpid()),
      fmt::format(".a.h5.{}.1.0.tmp", process_space()),
      fmt::format(".a.h5.other-host.{}.0.tmp", dead_process()),
      fmt::format(".a.h5.{}.x.0.tmp", process_space()),
      fmt::format(".a.h5.node~{}.{}.0.tmp", process_space(), dead_process()),
      fmt::format("a.h5.{}.{}.0.tmp", process_space(), dead_process()),
      fmt::format(".a.h5.{}.{}.0", process_space(), dead_process()),
      "results.h5",
      ".tmp",
  };
  folder.file(stale, "");
  for (const std::string& name : kept) folder.file(name, "");
  write_text_file(folder / "new.txt", "");
  EXPECT_FALSE(std::filesystem::exists(folder / stale));
  for (const std::string& name : kept) EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  EXPECT_EQ(remove_stale_temporaries(folder.path()), 0);
  EXPECT_EQ(remove_stale_temporaries(folder / "missing"), 0);
}

TEST(AtomicFile, ComesFromScratchWhenItIsComplete) {
  const TempFolder folder, scratch;
  {
    AtomicFile file(folder / "a.txt", scratch.path());
    EXPECT_EQ(file.temporary().parent_path(), scratch.path());
    std::ofstream(file.temporary()) << "content";
    EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
    file.commit();
  }
  EXPECT_EQ(read_text_file(folder / "a.txt"), "content");
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
  { const AtomicFile abandoned(folder / "b.txt", scratch.path()); }
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(AtomicFile, WhoHasEndedButWasNotWaitedForIsDead) {
  const TempFolder folder;
  const pid_t zombie = ::fork();
  if (zombie == 0) ::_exit(0);
  siginfo_t end = {};
  ::waitid(P_PID, static_cast<id_t>(zombie), &end, WEXITED | WNOWAIT);
  folder.file(fmt::format(".a.h5.{}.{}.0.tmp", process_space(), zombie), "");
  EXPECT_EQ(remove_stale_temporaries(folder.path()), 1);
  ::waitpid(zombie, nullptr, 0);
}

TEST(AtomicFile, RemovesStaleFoldersWithAllThatIsInThem) {
  const TempFolder folder;
  const auto stale = folder / fmt::format(".call.{}.{}.0.tmp", process_space(), dead_process());
  write_text_file(stale / "inside/x.csv", "1");
  EXPECT_EQ(remove_stale_temporaries(folder.path()), 1);
  EXPECT_EQ(folder.size(), 0);
}

TEST(AtomicFile, LooksForStaleTemporariesOncePerFolder) {
  const TempFolder folder;
  const std::string stale = fmt::format(".a.h5.{}.{}.0.tmp", process_space(), dead_process());
  write_text_file(folder / "first.txt", "");
  folder.file(stale, "");
  write_text_file(folder / "second.txt", "");
  EXPECT_TRUE(std::filesystem::exists(folder / stale));
}

TEST(AtomicFile, OthersSeeWhatIsInTheMaking) {
  const TempFolder folder;
  folder.file(fmt::format(".dead.h5.{}.{}.0.tmp", process_space(), dead_process()), "");
  folder.file("made.h5", "");
  const AtomicFile file(folder / "a.b.h5");  // whose folder forgets the dead one's
  EXPECT_EQ(files_in_the_making(folder.path()),
            (std::map<std::string, int>{{"a.b.h5", ::getpid()}}));
  EXPECT_TRUE(files_in_the_making(folder / "none").empty());
}

}  // namespace
}  // namespace npdr
