#include "pipeline/plan/work_folder.h"

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

TEST(WorkFolder, ALinkThatCannotBeMadeIsAnError) {
  const TempFolder folder;
  folder.file("readable", "a file, not a folder");
  EXPECT_THROW(make_link(folder / "first", folder.path() / "readable" / "link"), Error);
}

}  // namespace
}  // namespace npdr::pipeline
