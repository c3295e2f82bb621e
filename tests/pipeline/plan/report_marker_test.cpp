#include "pipeline/plan/report_marker.h"

#include "core/error.h"
#include "tests/pipeline/small_study.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

class ReportMarker : public FolderTest {
 protected:
  ReportMarker() { std::filesystem::create_directories(plan_.work.study("small")); }

  Plan plan_in_folder(const std::vector<std::string>& overrides = {}) const {
    return make_plan(parse_study(kStudyText, "s.toml", overrides), WorkFolder(folder_.path()));
  }

  Plan plan_ = plan_in_folder();
};

TEST_F(ReportMarker, KeepsTheVerdicts) {
  Node node;
  node.path = folder_ / "report.json";
  const Finding reason = {.id = "training.gap",
                          .severity = Severity::wrong,
                          .where = "Training",
                          .what = "what",
                          .evidence = "5 (fine up to 3)",
                          .advice = "do"};
  mark_report(node, "s.toml", {}, {{"A", 7, {"Training"}, {"RMSE"}, {}, {reason}}});
  const CheckSummary found = read_check_summaries(node).front();
  EXPECT_EQ(words_of(found), "A: 1 of 7 checks FAIL: Training; can't tell: RMSE");
  ASSERT_EQ(found.reasons.size(), 1u);
  EXPECT_EQ(found.reasons.front().id, reason.id);
  EXPECT_EQ(found.reasons.front().severity, reason.severity);
  EXPECT_EQ(found.reasons.front().where, reason.where);
  EXPECT_EQ(lines_of(found.reasons.front()), lines_of(reason));
  folder_.file("report.json", "{}");
  EXPECT_THROW(read_check_summaries(node), InputError);
  std::filesystem::remove(node.path);
  EXPECT_TRUE(read_check_summaries(node).empty()) << "another run may be making it anew";
}

TEST_F(ReportMarker, SaysWhatCantBeTrusted) {
  CheckSummary summary{.method = "A", .num_checks = 7};
  EXPECT_TRUE(has(trust_of(summary), "Trust its parameters and error bars"));
  summary.unknown = {"Bounds of the prior"};
  EXPECT_TRUE(has(trust_of(summary), "Too little is known to trust its parameters."));
  summary.failed = {"Residuals", "Held-out rollouts"};
  EXPECT_TRUE(has(trust_of(summary), "Don't trust its error bars and predictions."));
  EXPECT_EQ(trust_of({.method = "A"}), "") << "nothing was checked";
}

TEST_F(ReportMarker, TellsOfAllThatItsReportShows) {
  mark_report(plan_.nodes.back(), "s.toml", {}, {{"NPDR (MAF)", 7, {"Training"}, {}, {}, {}}});
  ASSERT_TRUE(reported_checks(plan_, "NPDR (MAF)"));
  EXPECT_EQ(reported_checks(plan_, "NPDR (MAF)")->failed.size(), 1u);
  EXPECT_FALSE(reported_checks(plan_, "NPDR (MoG)")) << "was never checked";
  EXPECT_TRUE(reported_checks(plan_in_folder({"study.seeds=[2]"}), "NPDR (MAF)"));
  EXPECT_FALSE(reported_checks(plan_in_folder({"study.seeds=[2, 3]"}), "NPDR (MAF)"));
  folder_.file("small/report.json", R"({"key_document": [[]]})");
  EXPECT_FALSE(reported_checks(plan_, "NPDR (MAF)")) << "damaged";
}

TEST_F(ReportMarker, OfAnotherBuildIsNotCurrent) {
  folder_.file("small/report.html", "");
  mark_report(plan_.nodes.back(), "s.toml", {}, {});
  EXPECT_TRUE(report_is_current(plan_, plan_.nodes.back()));
  const std::string marker = text_of(folder_ / "small/report.json");
  folder_.file("small/report.json", edited(marker, "\"revision\": \"", "\"revision\": \"other"));
  EXPECT_FALSE(report_is_current(plan_, plan_.nodes.back()));
}

}  // namespace
}  // namespace npdr::pipeline
