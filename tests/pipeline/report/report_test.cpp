#include <numbers>
#include <set>

#include "pipeline/report/parts.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/report.h"
#include "tests/pipeline/findings/findings_fixture.h"
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

// Contractions of the parameters of a golf's prior, of these samples.
std::vector<double> contractions(const StudyText::Lines& prior, const RowMatrix& theta) {
  const std::string study = minigolf_study("golf")
                                .with("simulator", {"store_every = 1"})
                                .only("prior", prior)
                                .method("NPDR (MAF)", {"num_simulations = 200"});
  const Plan plan = make_plan(parse_study(study, "s.toml"), WorkFolder("runs"));
  const analysis::Table table =
      contraction_table({plan, info_of(plan), {"NPDR (MAF)"}, {1}, {run_of(theta)}, {}}).value();
  std::vector<double> found;
  for (const analysis::Row& row : table.rows) {
    found.push_back(std::get<analysis::MeanStd>(row.cells[0].value).mean);
  }
  return found;
}

// Samples +-s of [-pi/2, pi/2], an obstacle's angle: at its middle, and the same around its end,
// where the copies modulo pi lie on the other side. Variance 2 s^2 (two values, n - 1).
TEST(ReportTables, ContractionKnowsPeriods) {
  const double s = 0.01, end = std::numbers::pi / 2;
  const std::string turn = " = { uniform = [-1.5707963267948966, 1.5707963267948966] }";
  const std::vector<double> found =
      contractions({"ball_restitution = { uniform = [0.0, 1.0] }", "obstacle1_dyaw" + turn,
                    "obstacle2_dyaw" + turn},
                   RowMatrix{{0.5 - s, -s, end - s}, {0.5 + s, s, -end + s}});
  EXPECT_NEAR(found[0], 1.0 - 2 * s * s * 12.0, 1e-6);
  EXPECT_NEAR(found[1], 1.0 - 2 * s * s * 12.0 / (std::numbers::pi * std::numbers::pi), 1e-6);
  EXPECT_NEAR(found[2], found[1], 1e-6);
  // A normal prior far wider than the period says nothing about the angle: nor does a posterior
  // that is even over it.
  const Vector even = Vector::LinSpaced(1000, -0.5, 0.499) * std::numbers::pi;
  EXPECT_NEAR(contractions({"obstacle2_dyaw = { normal = [0.0, 1.5] }"}, even)[0], 0.0, 0.05);
}

// The prior but for its few largest values, which make up most of its variance.
TEST(ReportTables, ContractionOfDecadesIsThatOfLogarithms) {
  const Vector exponents = Vector::LinSpaced(1000, -7.0, -3.1);
  const Vector theta = (std::log(10.0) * exponents.array()).exp();
  EXPECT_NEAR(contractions({"ball_rolling_friction = { log_uniform = [1e-7, 1e-3] }"}, theta)[0],
              1.0 - 3.9 * 3.9 / (4.0 * 4.0), 5e-3);
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
  for (const auto& entry : kTables) EXPECT_TRUE(names.insert(entry.name).second);
  EXPECT_TRUE(names.contains("fit"));
}

TEST(ReportTables, KnowTheBestValueOfAMetric) {
  EXPECT_EQ(ideal_of("goal"), 1.0);
  EXPECT_EQ(ideal_of("held_out_goal"), 1.0);
  EXPECT_EQ(ideal_of("held_out_rmse"), 0.0);
  TableOf<double> table{.caption = "",
                        .row_header = "",
                        .rows = {2.0},
                        .label = [](double) { return "row"; },
                        .ideal = [](double) { return 0.0; }};
  table.add_compared("A", [](double x) { return Cell(x); });
  EXPECT_TRUE(table.make().footnotes.empty()) << "nothing to compare with";
  table.add("prior", [](double x) { return Cell(x - 1.0); });
  table.add_compared("B", [](double x) { return Cell(x + 1.0); });
  const Table made = table.make();
  EXPECT_EQ(made.best_of(made.rows.front()), (std::vector<bool>{true, false, false}));
  EXPECT_EQ(made.footnotes, std::vector<std::string>{"Bold: the best method of a row"});
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

class NextSteps : public Verdicts {
 protected:
  NextSteps() {
    data_.methods.push_back(kOther);
    data_.runs.push_back(data_.runs.front());
    data_.runs.back().use.method = kOther;
    data_.diagnoses.push_back(data_.diagnoses.front());
    data_.diagnoses.back().use.method = kOther;
  }

  void fail(const std::string& method) {
    for (auto& diagnosis : data_.diagnoses) {
      if (diagnosis.use.method == method) diagnosis.result.training->is_converged = false;
    }
  }

  static constexpr const char* kOther = "NPDR (MoG)";
};

TEST_F(NextSteps, SayWhatTheChecksFoundOfEachPosterior) {
  fail(kMethod);
  EXPECT_TRUE(
      has(next_steps(data_),
          "npdr-maf/seed-1/round-1/infer.h5    # NPDR (MAF): 1 of 9 checks FAIL: Training\n"));
  EXPECT_TRUE(
      has(next_steps(data_),
          "npdr-mog/seed-1/round-1/infer.h5    # NPDR (MoG): all 9 checks pass; not checked: "
          "Calibration\n"));
}

TEST_F(NextSteps, GoOnWithTheFirstOfThoseOfWhichTheFewestFail) {
  EXPECT_TRUE(has(next_steps(data_), "npdr sample runs/small/npdr-maf/seed-1/"));
  EXPECT_FALSE(has(next_steps(data_), "fail: do first"));
  fail(kMethod);
  EXPECT_TRUE(has(next_steps(data_), "npdr sample runs/small/npdr-mog/seed-1/"));
  EXPECT_FALSE(has(next_steps(data_), "fail: do first")) << "the other one passes";
  fail(kOther);
  EXPECT_TRUE(
      has(next_steps(data_), "# Checks of NPDR (MAF) fail: do first what the verdicts say"));
}

TEST_F(NextSteps, DontTakeWhatWasNeverCheckedForGood) {
  plan_.study.diagnose.checks = {Check::training};
  plan_.study.methods.back().algorithm.kind = inference::Algorithm::abc_smc;
  fail(kMethod);
  EXPECT_TRUE(has(next_steps(data_), "infer.h5    # NPDR (MoG)\n"));
  EXPECT_TRUE(has(next_steps(data_), "npdr sample runs/small/npdr-maf/seed-1/"));
}

}  // namespace
}  // namespace npdr::pipeline
