#include "pipeline/plan/report_marker.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/pipeline/small_study.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

TEST(ReportMarker, KeepsTheVerdicts) {
  const TempFolder folder;
  Node node;
  node.path = folder / "report.json";
  mark_report(node, "s.toml", {}, {{"A", 7, {"Training"}, {"RMSE"}, {}, {"why"}}});
  const CheckSummary found = read_check_summaries(node).front();
  EXPECT_EQ(words_of(found), "A: 1 of 7 checks FAIL: Training; can't tell: RMSE");
  EXPECT_EQ(found.reasons, std::vector<std::string>{"why"});
  folder.file("report.json", "{}");
  EXPECT_THROW(read_check_summaries(node), InputError);
  std::filesystem::remove(node.path);
  EXPECT_TRUE(read_check_summaries(node).empty()) << "another run may be making it anew";
}

Plan plan_in(const TempFolder& folder, const std::vector<std::string>& overrides = {}) {
  return make_plan(parse_study(kStudyText, "s.toml", overrides), WorkFolder(folder.path()));
}

TEST(ReportMarker, TellsOfAllThatItsReportShows) {
  const TempFolder folder;
  const Plan plan = plan_in(folder);
  std::filesystem::create_directories(plan.work.study("small"));
  mark_report(plan.nodes.back(), "s.toml", {}, {{"NPDR (MAF)", 7, {"Training"}, {}, {}, {}}});
  ASSERT_TRUE(reported_checks(plan, "NPDR (MAF)"));
  EXPECT_EQ(reported_checks(plan, "NPDR (MAF)")->failed.size(), 1u);
  EXPECT_FALSE(reported_checks(plan, "NPDR (MoG)")) << "was never checked";
  EXPECT_TRUE(reported_checks(plan_in(folder, {"study.seeds=[2]"}), "NPDR (MAF)"));
  EXPECT_FALSE(reported_checks(plan_in(folder, {"study.seeds=[2, 3]"}), "NPDR (MAF)"));
  folder.file("small/report.json", R"({"key_document": [[]]})");
  EXPECT_FALSE(reported_checks(plan, "NPDR (MAF)")) << "damaged";
}

TEST(ReportMarker, OfAnotherBuildIsNotCurrent) {
  const TempFolder folder;
  const Plan plan = plan_in(folder);
  std::filesystem::create_directories(plan.work.study("small"));
  folder.file("small/report.html", "");
  mark_report(plan.nodes.back(), "s.toml", {}, {});
  EXPECT_TRUE(report_is_current(plan, plan.nodes.back()));
  const std::string marker = text_of(folder / "small/report.json");
  folder.file("small/report.json", edited(marker, "\"revision\": \"", "\"revision\": \"other"));
  EXPECT_FALSE(report_is_current(plan, plan.nodes.back()));
}

}  // namespace
}  // namespace npdr::pipeline
