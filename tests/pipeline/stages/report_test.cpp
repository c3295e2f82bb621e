#include "pipeline/stages/report_figures.h"
#include "pipeline/stages/report_tables.h"
#include "tests/pipeline/study_text.h"

namespace npdr::pipeline {
namespace {

using inference::Marginal;

Plan plan_of(const std::vector<std::string>& overrides = {}) {
  return make_plan(parse_study(kStudyText, "s.toml", overrides), WorkFolder("runs"));
}

TEST(ReportTables, SayWhichKindOfPriorAParameterHas) {
  const Plan plan = plan_of({"prior.gravity={ normal = [9.81, 0.05] }"});
  const analysis::Table table = parameters_table({plan, {}, {}, {}, {}});
  std::vector<std::string> priors;
  for (const analysis::Row& row : table.rows) {
    priors.push_back(std::get<std::string>(row.cells[1].value));
  }
  EXPECT_EQ(priors,
            (std::vector<std::string>{"[0.3, 1.7]", "[0.3, 1.7], log-uniform", "N(9.81, 0.05²)"}));
}

TEST(ReportFigures, SayWhatTheyLeaveOut) {
  Plan plan = plan_of();
  const ReportData six{plan, {"a", "b", "c", "d", "e", "f"}, {}, {}, {}};
  const ReportData seven{plan, {"a", "b", "c", "d", "e", "f", "g"}, {}, {}, {}};
  EXPECT_EQ(left_out_methods(six), "");
  EXPECT_EQ(left_out_methods(seven), " The first 6 of 7 methods.");
  EXPECT_EQ(left_out_parameters(plan.study), "");
  plan.study.prior.resize(16, plan.study.prior.front());
  EXPECT_EQ(left_out_parameters(plan.study), " 15 of 16 parameters.");
  plan.study.report.parameters = {"pole_mass", "pole_length"};
  EXPECT_EQ(left_out_parameters(plan.study), " 2 of 16 parameters.");
}

}  // namespace
}  // namespace npdr::pipeline
