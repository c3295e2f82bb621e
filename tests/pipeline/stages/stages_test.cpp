#include "pipeline/stages/stages.h"

#include "pipeline/artefacts/diagnosis_file.h"
#include "pipeline/artefacts/network_file.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/features/observation.h"
#include "pipeline/findings/data.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/report/registry.h"
#include "pipeline/run/run_stage.h"
#include "sim/observation_noise.h"
#include "tests/pipeline/small_study.h"
#include "tests/pipeline/stages/run_until.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

// Two methods that differ in their names alone.
std::string twins() {
  const StudyText::Lines lines = {"num_simulations = 30", "embedding = { kind = \"bayessim\" }",
                                  kSmallMixture, "training = { max_epochs = 2, batch_size = 10 }"};
  return pendulum_study("twins")
      .with("study", {"seeds = [1, 2]"})
      .only("prior", {"pole_length = { uniform = [0.5, 1.5] }"})
      .method("A", lines)
      .method("B", lines)
      .with("evaluate", {"num_samples = 20", "metrics = [\"rmse\"]"});
}

class SmallStages : public FolderTest {
 protected:
  Plan plan_of(const std::vector<std::string>& overrides = {}) const {
    return make_plan(parse_study(twins(), "twins.toml", overrides), WorkFolder(folder_.path()));
  }

  // Of rollouts of a Furuta pendulum, with noise.
  Plan furuta_plan(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all = {"simulator.name=furuta",
                                    "simulator.store_every=25",
                                    "target.num_rollouts=2",
                                    "prior={ pole_mass = { uniform = [0.0168, 0.0312] } }",
                                    "target.truth={ pole_mass = 0.03 }",
                                    "method.embedding={ kind = 'all_steps', downsample = 25 }",
                                    "evaluate.leave_out=2",
                                    "study.seeds=[1]",
                                    "observation_noise.scale=0.1"};
    all.insert(all.end(), more.begin(), more.end());
    return plan_of(all);
  }
};

TEST_F(SmallStages, TwinMethodsCountEachSampleOnce) {
  const Plan plan = plan_of();
  run_until(plan, Stage::evaluate);
  const ReportData data = read_report_data(plan, plan.node(Stage::report, {}));
  EXPECT_EQ(data.methods, (std::vector<std::string>{"A", "B"}));
  for (const std::string& method : data.methods) {
    Index n = 0;
    for (const EvaluatedRun* run : data.runs_of(method)) n += run->evaluation.theta.rows();
    EXPECT_EQ(n, 2 * 20) << method;
  }
}

double number_of(const analysis::Cell& cell) {
  if (const double* number = std::get_if<double>(&cell.value)) return *number;
  return std::get<analysis::MeanStd>(cell.value).mean;
}

TEST_F(SmallStages, PredictionsOfFoldsAndBaselinesAreScored) {
  const Plan plan = furuta_plan();
  run_until(plan, Stage::evaluate);
  run_stage(plan, plan.node(Stage::baseline, {}));
  const ReportData data = read_report_data(plan, plan.node(Stage::report, {}));
  ASSERT_EQ(data.folds.size(), 4u) << "two of each method";
  const analysis::Table table = scores_table(data).value(),
                        details = scores_details_table(data).value();
  EXPECT_EQ(table.columns, (std::vector<std::string>{"A", "B", "prior", "nominal", "truth"}));
  EXPECT_EQ(table.columns, details.columns);
  EXPECT_EQ(table.compared, (std::vector<std::size_t>{0, 1})) << "of methods alone";
  EXPECT_EQ(table.rows.size(), 2u * 3u) << "of seen and left-out rollouts";
  const auto row = [](const analysis::Table& of, const std::string& label) {
    return std::ranges::find(of.rows, label, &analysis::Row::label)->cells;
  };
  double left_out = 0.0;
  for (const EvaluatedRun* fold : data.folds_of({.method = "A", .seed = 1})) {
    left_out += fold->evaluation.scores.held_out->crps.mean() / 2.0;
  }
  EXPECT_DOUBLE_EQ(number_of(row(details, "CRPS, left out")[0]), left_out);
  EXPECT_NE(number_of(row(details, "CRPS")[0]), left_out);
  EXPECT_LT(number_of(row(details, "CRPS")[4]), 1e-6) << "the truth, without noise";
  // 0.1 / sqrt(pi), from some hundred errors: a standard error of 0.004 at most, tolerance of five.
  EXPECT_NEAR(number_of(row(table, "CRPS with noise")[4]), 0.0564, 0.02);
  EXPECT_EQ(number_of(row(details, "90 % bands cover")[3]), 0.0) << "a point, not a band";
  for (const analysis::Row& score : table.rows) {
    EXPECT_EQ(score.ideal, score.label.starts_with("CRPS")        ? -kInfinity
                           : score.label.starts_with("log score") ? kInfinity
                                                                  : 0.9)
        << score.label;
  }
}

// The noise of the states that a node sees of the target, (H, K C), over their amplitude.
RowMatrix noise_of(const Plan& plan, const Target& target) {
  const Index store_every = plan.study.simulator.store_every;
  const std::vector<float> exact = inference::observed_series(target, store_every),
                           observed = Observation(plan.study, target).states();
  const Index size = std::ssize(exact) / target.num_rollouts();
  const RowMatrixF noise = RowMatrixF::Map(observed.data(), target.num_rollouts(), size) -
                           RowMatrixF::Map(exact.data(), target.num_rollouts(), size);
  const RowMatrix amplitude = sim::reference_amplitude(target);
  return (noise.cast<double>().array() / amplitude.replicate(1, size / target.num_states()).array())
      .matrix();
}

TEST_F(SmallStages, ARolloutOfASimulatedTargetIsObservedOnce) {
  const Plan plan = furuta_plan({"target.held_out=1"});
  for (const Node& node : plan.nodes) {
    if (node.stage == Stage::target || node.stage == Stage::held_out) run_stage(plan, node);
  }
  const Node& whole = plan.node(Stage::evaluate, {"A", 1, 1});
  const RowMatrix seen = noise_of(plan, read_target(plan, whole));
  for (const Index fold : {1, 2}) {
    const Node& node = plan.node(Stage::evaluate, {"A", 1, 1, 0, fold});
    EXPECT_EQ(noise_of(plan, *read_held_out(plan, node)).row(0), seen.row(fold - 1));
    EXPECT_EQ(noise_of(plan, read_target(plan, node)).row(0), seen.row(2 - fold));
  }
  // Numbers of independent noise have a correlation of 0 +- 1 / sqrt(n): five times that is a false
  // alarm in a million.
  const RowMatrix held_out = noise_of(plan, *read_held_out(plan, whole));
  for (const Index h : {0, 1}) {
    const double correlation =
        seen.row(h).dot(held_out.row(0)) / (seen.row(h).norm() * held_out.row(0).norm());
    EXPECT_LT(std::abs(correlation), 5.0 / std::sqrt(static_cast<double>(seen.cols()))) << h;
  }
}

TEST_F(SmallStages, TheLimitOfFailuresHoldsForSimulationsThatAreThere) {
  // A rod of some grams and centimeters: the integration diverges in some rows.
  const auto with_limit = [&](const std::string& limit) {
    return plan_of({"prior.pole_length={ uniform = [0.01, 0.1] }",
                    "simulator.parameters={ pole_mass = 0.02 }",
                    "limits.max_failed_fraction=" + limit});
  };
  const Plan lenient = with_limit("1");
  run_until(lenient, Stage::simulate);
  const Plan strict = with_limit("0");
  const Node& infer = strict.node(Stage::infer, {"A", 1, 1});
  ASSERT_EQ(infer.key, lenient.node(Stage::infer, {"A", 1, 1}).key);
  EXPECT_THROW(run_stage(strict, infer), FailedRolloutsError);
  run_until(lenient, Stage::evaluate);
  // The posteriors are there now; the report is what is made anew.
  EXPECT_THROW(run_stage(strict, strict.node(Stage::report, {})), FailedRolloutsError);
}

TEST_F(SmallStages, ADiagnosisHoldsWhatItWasAskedFor) {
  const Plan plan = plan_of({"diagnose={ num_simulations = 40, num_samples = 50 }",
                             "method.num_simulations=60", "study.seeds=[1]"});
  run_until(plan, Stage::diagnose);
  const Diagnosis all = kDiagnosisSchema.read(plan.node(Stage::diagnose, {"A", 1, 0}));
  EXPECT_EQ(all.num_simulations + all.num_failed, 40);
  EXPECT_EQ(all.sbc->ranks.rows(), all.num_simulations);
  EXPECT_EQ(all.sbc->ranks.cols(), 1);
  EXPECT_LE(all.sbc->ranks.maxCoeff(), 50);
  EXPECT_EQ(all.coverage->levels.size(), all.num_simulations);
  EXPECT_EQ(all.local_c2st->null.size(), 200);
  EXPECT_EQ(all.predictive->names.size(), 10u);
  EXPECT_EQ(all.training->num_epochs, 2);
  EXPECT_FALSE(all.training->is_converged) << "max_epochs = 2";
  EXPECT_EQ(all.p_values().size(), 7u);

  const Plan some = plan_of({"diagnose={ checks = ['training', 'coverage'], num_simulations = 40 }",
                             "method.num_simulations=60", "study.seeds=[1]"});
  run_until(some, Stage::diagnose);
  const Diagnosis two = kDiagnosisSchema.read(some.node(Stage::diagnose, {"A", 1, 0}));
  EXPECT_TRUE(two.coverage && two.training);
  EXPECT_FALSE(two.sbc || two.tarp || two.local_c2st || two.predictive || two.ood);
}

// Draws of the prior for calibration are others than those of training, and so is their noise.
TEST_F(SmallStages, CalibrationHasDrawsOfItsOwn) {
  const Plan plan = plan_of(
      {"diagnose={ num_simulations = 40 }", "method.num_simulations=40", "study.seeds=[1]"});
  run_until(plan, Stage::simulate);
  const RowMatrix first =
      read_proposal(open_proposal(plan.node(Stage::propose, {"A", 1, 1})), {0, 40});
  const RowMatrix fresh =
      read_proposal(open_proposal(plan.node(Stage::propose, {"A", 1, 0})), {0, 40});
  EXPECT_EQ((first.array() == fresh.array()).count(), 0);
}

// A checkpoint after one epoch.
inference::TrainingState state_of(const VectorF& parameters) {
  inference::TrainingState state;
  state.parameters = state.average = state.best_parameters = parameters;
  state.adam.first_moment = state.adam.second_moment = VectorF::Zero(parameters.size());
  state.adam.num_steps = 1;
  state.epoch = 1;
  state.best_validation_loss = 1.0;
  state.training_loss = state.validation_loss = {1.0};
  return state;
}

TEST_F(SmallStages, TrainingGoesOnFromItsCheckpoint) {
  const Plan plan = plan_of();
  const Node& infer = plan.node(Stage::infer, {"A", 1, 1});
  run_until(plan, Stage::infer);
  const VectorF weights = read_network_posterior(infer.path)->parts().parameters;
  std::filesystem::remove(infer.path);

  const std::filesystem::path checkpoint = plan.work.checkpoint("infer", infer.key);
  kCheckpointSchema.write(checkpoint, infer.identity,
                          {{state_of(VectorF::Zero(weights.size() + 16))}, {}});
  const std::string message = message_of<InputError>([&] { run_stage(plan, infer); }, &folder_);
  EXPECT_TRUE(
      has(message, ".checkpoint.h5: training state: " + std::to_string(weights.size() + 16) +
                       " parameters, must be " + std::to_string(weights.size()) +
                       ", as many as the network's; remove it and rerun stage 'infer'"));

  kCheckpointSchema.write(checkpoint, infer.identity, {{state_of(weights)}, {}});
  const std::string digest = content_digest(checkpoint);
  kCheckpointSchema.write(checkpoint, infer.identity, {{state_of(weights)}, {1000.0, 3000.0}});
  EXPECT_EQ(content_digest(checkpoint), digest) << "time is no content";
  run_stage(plan, infer);
  EXPECT_GE(provenance_of(h5::File::open(infer.path)).cost.wall_seconds, 1000.0);
}

}  // namespace
}  // namespace npdr::pipeline
