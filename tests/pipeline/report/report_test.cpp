#include <numbers>
#include <set>

#include "pipeline/report/figure_parts.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/texts.h"
#include "tests/pipeline/small_study.h"

namespace npdr::pipeline {
namespace {

using inference::Marginal;

Plan plan_of(const std::vector<std::string>& overrides = {}) {
  return make_plan(parse_study(kStudyText, "s.toml", overrides), WorkFolder("runs"));
}

sim::SimulatorInfo info_of(const Plan& plan) {
  return sim::make_simulator(plan.study.simulator)->info();
}

// One run whose posterior samples are `theta`.
EvaluatedRun run_of(const RowMatrix& theta) {
  EvaluatedRun run;
  run.use = {"NPDR (MAF)", 1, 1};
  run.last_round = true;
  run.evaluation.theta = theta;
  return run;
}

TEST(ReportTables, SayWhichKindOfPriorAParameterHas) {
  const Plan plan = plan_of(
      {"prior.gravity={ normal = [9.81, 0.05] }", "prior.damping={ log_normal = [-3.0, 0.5] }"});
  const analysis::Table table =
      parameters_table(
          {plan, info_of(plan), {"NPDR (MAF)"}, {1}, {run_of(RowMatrix::Ones(2, 4))}, {}})
          .value();
  std::vector<std::string> priors;
  for (const analysis::Row& row : table.rows) {
    priors.push_back(std::get<std::string>(row.cells[1].value));
  }
  EXPECT_EQ(priors, (std::vector<std::string>{"[0.3, 1.7]", "[0.3, 1.7], log-uniform",
                                              "N(9.81, 0.05²)", "exp N(-3, 0.5²)"}));
}

Plan golf_plan_of(const StudyText::Lines& prior) {
  const std::string study = minigolf_study("golf")
                                .with("simulator", {"store_every = 1"})
                                .only("prior", prior)
                                .method("NPDR (MAF)", {"num_simulations = 200"});
  return make_plan(parse_study(study, "s.toml"), WorkFolder("runs"));
}

double contraction(const analysis::Table& table, std::size_t parameter) {
  return std::get<analysis::MeanStd>(table.rows[parameter].cells[0].value).mean;
}

// Samples +-s of [-pi/2, pi/2], an obstacle's angle: at its middle, and the same around its end,
// where the copies modulo pi lie on the other side. Variance 2 s^2 (two values, n - 1).
TEST(ReportTables, ContractionKnowsPeriods) {
  const Plan plan =
      golf_plan_of({"ball_restitution = { uniform = [0.0, 1.0] }",
                    "obstacle1_dyaw = { uniform = [-1.5707963267948966, 1.5707963267948966] }",
                    "obstacle2_dyaw = { uniform = [-1.5707963267948966, 1.5707963267948966] }"});
  const double s = 0.01, end = std::numbers::pi / 2;
  RowMatrix theta(2, 3);
  theta << 0.5 - s, -s, end - s, 0.5 + s, s, -end + s;
  const analysis::Table table =
      contraction_table({plan, info_of(plan), {"NPDR (MAF)"}, {1}, {run_of(theta)}, {}}).value();
  EXPECT_NEAR(contraction(table, 0), 1.0 - 2 * s * s * 12.0, 1e-6);
  const double turn = std::numbers::pi * std::numbers::pi / 12.0;
  EXPECT_NEAR(contraction(table, 1), 1.0 - 2 * s * s / turn, 1e-6);
  EXPECT_NEAR(contraction(table, 2), contraction(table, 1), 1e-6);
}

// A normal prior far wider than the period says nothing about the angle: nor does a posterior that
// is even over it.
TEST(ReportTables, ContractionOfAWideNormalIsThatOfItsAngle) {
  const Plan plan = golf_plan_of({"obstacle2_dyaw = { normal = [0.0, 1.5] }"});
  RowMatrix theta(1000, 1);
  for (Index i = 0; i < 1000; ++i) theta(i, 0) = std::numbers::pi * (double(i) / 1000.0 - 0.5);
  const analysis::Table table =
      contraction_table({plan, info_of(plan), {"NPDR (MAF)"}, {1}, {run_of(theta)}, {}}).value();
  EXPECT_NEAR(contraction(table, 0), 0.0, 0.05);
}

// The prior but for its few largest values, which make up most of its variance.
TEST(ReportTables, ContractionOfDecadesIsThatOfLogarithms) {
  const Plan plan = golf_plan_of({"ball_rolling_friction = { log_uniform = [1e-7, 1e-3] }"});
  RowMatrix theta(1000, 1);
  for (Index i = 0; i < 1000; ++i) theta(i, 0) = std::pow(10.0, -7.0 + 3.9 * (double(i) / 999.0));
  const analysis::Table table =
      contraction_table({plan, info_of(plan), {"NPDR (MAF)"}, {1}, {run_of(theta)}, {}}).value();
  EXPECT_NEAR(contraction(table, 0), 1.0 - 3.9 * 3.9 / (4.0 * 4.0), 5e-3);
}

// Of two channels one has noise, whose parameters all have priors. The third sample has failed.
TEST(ReportTables, NoiseIsThatOfChannelsThatHaveAny) {
  const Plan plan = plan_of({"observation_noise.std={ theta = 0.01 }",
                             "observation_noise.correlation_prior=[0.5, 1.0]",
                             "observation_noise.degrees_of_freedom_prior=[4.0, 1.0]"});
  ReportData data{plan, info_of(plan), {"NPDR (MAF)"}, {1}, {run_of(RowMatrix::Ones(3, 2))}, {}};
  data.target.rollouts = {{"", RowMatrix::Ones(11, 2), RowMatrix::Ones(10, 1)}};
  data.target.state_channels = data.info.state_channels;
  data.target.action_channels = data.info.action_channels;
  ASSERT_FALSE(noise_table(data));
  const RowMatrix all{{1.0, 9.0}, {3.0, 9.0}, {std::nan(""), 9.0}};
  data.runs.front().evaluation.noise = {all, 0.1 * all, 2.0 * all};
  const analysis::Table table = noise_table(data).value();
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0].label, "correlation of theta");
  EXPECT_EQ(table.rows[1].label, "degrees of freedom of theta");
  const auto text = [&](std::size_t row, std::size_t cell) {
    return std::get<std::string>(table.rows[row].cells[cell].value);
  };
  EXPECT_EQ(text(0, 0), "0.5 (0.269 to 0.731)");
  EXPECT_EQ(text(0, 1), "0.2 (0.132 to 0.268)");
  EXPECT_EQ(text(1, 0), "4 (2.1 to 9.15)");
  EXPECT_EQ(text(1, 1), "4 (2.64 to 5.36)");
  EXPECT_EQ(table.footnotes.size(), 1u) << "one sample has failed";
}

// Two of one name would write the same files.
TEST(ReportTables, HaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const TableEntry& entry : kTables) EXPECT_TRUE(names.insert(entry.name).second);
  EXPECT_TRUE(names.contains("fit"));
}

TEST(Reports, SayWhatTwoKindsOfNetworksHaveToDoWithTheDefault) {
  const Study study = plan_of({"method.\"NPDR (MoG)\".algorithm='npe_c'"}).study;
  EXPECT_EQ(pooling_text(study).find("NPDR (MAF) combines two kinds of neural networks"), 0u);
  EXPECT_EQ(pooling_text(plan_of().study).find("NPDR (MAF) and NPDR (MoG) combine two"), 0u);
  EXPECT_EQ(pooling_text(plan_of({"method.algorithm='npe_c'"}).study), "");
}

TEST(ReportFigures, SayWhatTheyLeaveOut) {
  const std::vector<std::string> six(6, "a"), seven(7, "a");
  EXPECT_EQ(left_out_methods(six), "");
  EXPECT_EQ(left_out_methods(seven), " The first 6 of 7 methods.");
  Study study = plan_of().study;
  EXPECT_EQ(left_out_parameters(study), "");
  study.prior.resize(16, study.prior.front());
  EXPECT_EQ(left_out_parameters(study), " 15 of 16 parameters.");
  study.report.parameters = {"pole_mass", "pole_length"};
  EXPECT_EQ(left_out_parameters(study), " 2 of 16 parameters.");
}

}  // namespace
}  // namespace npdr::pipeline
