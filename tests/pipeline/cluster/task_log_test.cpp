#include "pipeline/cluster/task_log.h"

#include <gtest/gtest.h>
#include <optional>

#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

class TaskLog : public FolderTest {
 protected:
  std::optional<TaskEnd> end_of(const std::string& text) const {
    return end_in_log(folder_.file("a.log", text));
  }
};

TEST_F(TaskLog, SaysWhyATaskEnded) {
  const auto end = end_of(begin_line("17_3", {"npdr-simulate", "a b.toml"}) +
                          "\nnpdr-simulate: a.toml: can't be opened\n" + end_line(2, 0.04) + "\n");
  ASSERT_TRUE(end);
  EXPECT_EQ(end->exit_status, 2);
  EXPECT_EQ(end->words, "exit status 2 after 0.0 s: npdr-simulate: a.toml: can't be opened");
  const auto of_run = end_of(begin_line("17", {"npdr", "run"}) +
                             "\nnpdr: infer NPE, seed 1, round 1 failed (exit status 1):\n"
                             "    npdr-infer: the disk is full\n    log: runs/a.log\n" +
                             end_line(1, 2.0) + "\n");
  ASSERT_TRUE(of_run);
  EXPECT_EQ(of_run->words, "exit status 1 after 2.0 s: npdr-infer: the disk is full");
}

TEST_F(TaskLog, OfATaskThatWasKilledSaysNothing) {
  EXPECT_FALSE(end_in_log(folder_ / "none.log"));
  const std::string begin = begin_line("17_3", {"npdr-simulate"}) + "\n";
  EXPECT_FALSE(end_of(begin));
  EXPECT_FALSE(end_of(begin + end_line(75, 3.0) + "\n" + begin + "half a li"));
}

}  // namespace
}  // namespace npdr::pipeline
