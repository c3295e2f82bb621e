#include "tests/faults/fault_study.h"
#include "tests/faults/tiny_disk.h"
#include "tests/file_size_limit.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

class Folders : public Faults {
 protected:
  // That a program says what is wrong with `place`, with one of the statuses of failure.
  static void expect_named(const Outcome& outcome, const std::string& place) {
    EXPECT_TRUE(outcome.status == 1 || outcome.status == 2) << outcome.status << outcome.err;
    EXPECT_TRUE(has(outcome.err, place));
  }
};

// Nothing depends on the times of files: they come from other clocks, or from a copy.
TEST_F(Folders, TimesOfFilesMeanNothing) {
  const auto touch = [&](std::chrono::hours offset) {
    for (const auto& entry : fs::recursive_directory_iterator(folder_->path())) {
      if (entry.is_symlink()) continue;
      fs::last_write_time(entry.path(), fs::file_time_type::clock::now() + offset);
    }
  };
  const Artefact posterior = folder_->artefacts_of("infer").back();
  for (const int years : {-30, 30}) {
    touch(std::chrono::hours(years * 365 * 24));
    EXPECT_EQ(folder_->npdr({"run", "--dry-run"}).out, "");
    for (const Artefact& artefact : folder_->artefacts()) {
      EXPECT_EQ(artefact.state, "up to date") << artefact.label;
    }
    // The new file is older, or newer, than all that it is made from and that is made of it.
    fs::remove(posterior.path);
    folder_->npdr(0, {"run"});
    EXPECT_EQ(folder_->npdr({"run", "--dry-run"}).out, "");
  }
  expect_same_results();
}

TEST_F(Folders, AReadOnlyWorkFolderCanBeLookedAtButNotWorkedIn) {
  const fs::path finished = folder_->path() / "finished";
  fs::rename(folder_->work(), finished);
  {
    const TinyDisk disk(folder_->work(), "size=8m");
    if (!disk.is_there()) {
      fs::remove_all(folder_->work());
      fs::rename(finished, folder_->work());
      GTEST_SKIP() << disk.why_not();
    }
    fs::copy(finished, folder_->work(),
             fs::copy_options::recursive | fs::copy_options::copy_symlinks);
    const Artefact posterior = folder_->artefacts_of("infer").back();
    fs::remove(posterior.path);
    disk.make_read_only();
    folder_->npdr(0, {"status"});
    const Outcome failed = make(posterior);
    expect_named(failed, posterior.path.filename());
    EXPECT_TRUE(has(failed.err, "make the folder writable"));
    expect_named(folder_->npdr({"run"}), "make the folder writable");
  }
  fs::remove_all(folder_->work());
  fs::rename(finished, folder_->work());
}

TEST_F(Folders, NoMoreFilesIsAnErrorThatSaysSo) {
  const fs::path other = folder_->path() / "other";
  const TinyDisk disk(other, "size=8m,nr_inodes=12");
  if (!disk.is_there()) GTEST_SKIP() << disk.why_not();
  EXPECT_TRUE(
      has(folder_->npdr(1, {"run", "--work", "other"}).err, {"No space left on device", "df -i"}));
}

TEST_F(Folders, AWorkFolderThatDisappearsEndsTheRunAndTheNextOneGoesOn) {
  const fs::path gone = folder_->path() / "gone";
  fs::remove_all(folder_->cache() / "infer");
  fs::remove_all(folder_->cache() / "evaluate");
  const Program program(folder_->path(), FaultFolder::npdr_words({"run"}));
  EXPECT_TRUE(begins_to_make(program, folder_->cache()));
  fs::rename(folder_->work(), gone);
  expect_named(program.wait(), "runs/");
  fs::remove_all(folder_->work());
  fs::rename(gone, folder_->work());
  expect_to_go_on();
}

TEST_F(Folders, WhatIsInTheWayIsNamed) {
  fs::create_symlink("loop", folder_->path() / "loop");
  expect_named(folder_->npdr({"run", "--work", "loop"}), "loop");
  EXPECT_TRUE(has(folder_->npdr({"status", "--work", "loop"}).out, "leads to itself"));

  std::ofstream(folder_->path() / "a_file") << "text";
  expect_named(folder_->npdr({"run", "--work", "a_file"}), "a_file");

  const Artefact posterior = folder_->artefacts_of("infer").front();
  const Artefact proposal = folder_->artefacts_of("propose").back();
  for (const Artefact& artefact : {posterior, proposal}) {
    fs::remove(artefact.path);
    fs::create_directory(artefact.path);
    EXPECT_TRUE(has(folder_->npdr({"status"}).out, "is a folder"));
    expect_named(folder_->npdr({"run"}), "is a folder, must be a file");
    fs::remove(artefact.path);
    fs::create_symlink(artefact.path.filename(), artefact.path);
    expect_named(folder_->npdr({"run"}), artefact.path.filename());
    EXPECT_TRUE(has(folder_->npdr({"status"}).out, "leads to itself"));
    fs::remove(artefact.path);
  }
  expect_to_go_on();
}

// A limit stands for a quota.
TEST_F(Folders, AFileThatMayNotGrowIsAnErrorAndNothingIsLeft) {
  const Artefact artefact = folder_->artefacts_of("infer").front();
  fs::remove_all(artefact.path);
  {
    const FileSizeLimit limit(10'000);
    EXPECT_TRUE(has(with_status(1, make(artefact)).err,
                    {"File too large; raise the limit", artefact.path.filename()}));
  }
  expect_to_go_on();
}

}  // namespace
}  // namespace npdr::pipeline
