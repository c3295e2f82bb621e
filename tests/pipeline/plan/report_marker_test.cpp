#include "pipeline/plan/report_marker.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

TEST(ReportMarker, KeepsTheVerdicts) {
  const TempFolder folder;
  Node node;
  node.path = folder / "report.json";
  mark_report(node, "s.toml", {}, {{"A", 7, {"Training"}, {"RMSE"}, {"why"}}});
  const CheckSummary found = read_check_summaries(node).front();
  EXPECT_EQ(words_of(found), "A: 1 of 7 checks FAIL: Training; can't tell: RMSE");
  EXPECT_EQ(found.reasons, std::vector<std::string>{"why"});
  folder.file("report.json", "{}");
  EXPECT_THROW(read_check_summaries(node), InputError);
  std::filesystem::remove(node.path);
  EXPECT_TRUE(read_check_summaries(node).empty()) << "another run may be making it anew";
}

}  // namespace
}  // namespace npdr::pipeline
