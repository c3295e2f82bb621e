#include "pipeline/artefacts/work_folder.h"

#include <sys/wait.h>
#include <unistd.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

TEST(WorkFolder, LinksAreRelativeAndCanBeRenewed) {
  const TempFolder folder;
  folder.file("first", "1");
  folder.file("second", "2");
  const auto link = folder.path() / "readable" / "link";
  make_link(folder / "first", link);
  EXPECT_EQ(text_of(link), "1");
  EXPECT_TRUE(std::filesystem::read_symlink(link).is_relative());
  make_link(folder / "second", link);
  EXPECT_EQ(text_of(link), "2");
}

TEST(WorkFolder, WhatAKilledProcessLeftBesideALinkIsRemoved) {
  const TempFolder folder;
  folder.file("first", "1");
  const pid_t dead = ::fork();
  if (dead == 0) ::_exit(0);
  ::waitpid(dead, nullptr, 0);
  const auto readable = folder.path() / "readable";
  std::filesystem::create_directory(readable);
  const auto stale =
      readable / (".link." + process_space() + "." + std::to_string(dead) + ".0.tmp");
  std::filesystem::create_symlink("../first", stale);
  make_link(folder / "first", readable / "link");
  EXPECT_FALSE(std::filesystem::is_symlink(stale));
}

TEST(WorkFolder, ALinkThatCannotBeMadeIsAnError) {
  const TempFolder folder;
  folder.file("readable", "a file, not a folder");
  EXPECT_THROW(make_link(folder / "first", folder.path() / "readable" / "link"), Error);
}

}  // namespace
}  // namespace npdr::pipeline
