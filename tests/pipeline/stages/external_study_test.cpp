/// Studies with a command or a dataset in place of a built-in simulator: problems and keys.
#include "pipeline/artefacts/dataset_file.h"
#include "pipeline/features/observation.h"
#include "pipeline/plan/plan.h"
#include "tests/pipeline/small_study.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

std::string two_methods() {
  return command_study("command")
      .with("simulator", {"command = \"sh sim.sh\""})
      .with("prior", {"b = { normal = [0.0, 1.0] }"})
      .method("A", {"num_simulations = 100"})
      .method("B", {"num_simulations = 100", "density_estimator = { kind = \"mdn\" }"});
}

class ExternalStudies : public ::testing::Test {
 protected:
  ExternalStudies() {
    folder_.file("x_o.csv", "peak [m],mean\n1,2\n");
    folder_.file("sim.sh", "exit 0");
    import_dataset(folder_.file("theta.csv", "b,a\n1,2\n3,4\n"),
                   folder_.file("x.csv", "1,2\n3,4\n"), folder_ / "d.h5");
  }

  Study study_of(const std::vector<std::string>& overrides = {}) const {
    return parse_study(two_methods(), folder_ / "s.toml", overrides);
  }
  Plan plan_of(const std::vector<std::string>& overrides = {},
               const Selection& selection = {}) const {
    return make_plan(study_of(overrides), WorkFolder(folder_ / "work"), selection);
  }
  std::string problems(const std::vector<std::string>& overrides) const {
    std::string text = message_of<InputError>([&] { plan_of(overrides); }, &folder_);
    const std::string prefix = "--set " + overrides.front() + ": ";
    return text.starts_with(prefix) ? text.substr(prefix.size()) : text;
  }

  TempFolder folder_;
};

TEST_F(ExternalStudies, HaveDefaultsOfTheirOwn) {
  const Study study = study_of();
  EXPECT_EQ(study.methods.front().embedding.kind, inference::EmbeddingKind::identity);
  EXPECT_EQ(study.evaluate.metrics, std::vector<Metric>{Metric::distance});
  EXPECT_FALSE(study.evaluate.floor);
  EXPECT_EQ(study.external.folder, folder_.path().string() + "/");
  EXPECT_EQ(plan_of().study.external.features, (std::vector<std::string>{"peak [m]", "mean"}));
}

TEST_F(ExternalStudies, ReportWhatMeansNothingToThem) {
  for (const char* assignment :
       {"simulator.substeps=2", "simulator.integrator=\"erk4\"", "target.num_rollouts=1",
        "method.num_rollouts=1", "method.embedding.downsample=1", "evaluate.floor=true"}) {
    const std::string key = std::string(assignment).substr(0, std::string(assignment).find('='));
    EXPECT_TRUE(has(problems({assignment}), key + " must be left out: ")) << assignment;
  }
  EXPECT_TRUE(says(problems({"method.\"A\".embedding.kind=linear"}),
                   {"method.embedding.kind = 'linear'", "must be 'identity'", "no rollouts"}));
  EXPECT_TRUE(says(problems({"evaluate.metrics=[\"rmse\"]"}),
                   {"evaluate.metrics", "must be left out", "no rollouts"}));
}

TEST_F(ExternalStudies, AndBuiltInSimulatorsReportWhatIsTheirs) {
  const auto problem = [](const std::string& assignment) {
    return edited(problems_of(kStudyText, {assignment}), "--set " + assignment + ": ", "");
  };
  EXPECT_TRUE(says(problem("simulator.retries=1"),
                   {"simulator.retries", "must be left out", "simulator.command"}));
  EXPECT_TRUE(says(problem("simulator.features=[\"x\"]"),
                   {"simulator.features", "must be left out", "state channels"}));
  EXPECT_TRUE(says(problem("evaluate.metrics=[\"distance\"]"),
                   {"evaluate.metrics = 'distance'", "must be left out", "simulator.command"}));
  EXPECT_TRUE(has(problem("method.embedding.kind=identity"), "'all_steps' keeps all states"));
}

TEST_F(ExternalStudies, AreExactlyOneOfThree) {
  EXPECT_TRUE(says(message_of<InputError>(
                       [&] {
                         parse_study(
                             edited(two_methods(), "[prior]", "name = \"pendulum\"\n[prior]"),
                             folder_ / "s.toml");
                       },
                       &folder_),
                   {"s.toml:6:11: simulator has name and command", "must have one of them"}));
  EXPECT_EQ(study_of({"simulator.dataset=" + (folder_ / "d.h5").string()}).external.command,
            std::nullopt)
      << "the command line replaces the command";
}

TEST_F(ExternalStudies, ATypoOfTheirFirstKeyIsAnUnknownKey) {
  const std::string text = message_of<InputError>(
      [&] { parse_study(edited(two_methods(), "command =", "comand ="), folder_ / "s.toml"); },
      &folder_);
  EXPECT_TRUE(has(text, "s.toml:6:1: simulator: unknown key 'comand' (did you mean 'command'?)"));
}

TEST_F(ExternalStudies, HaveNoEquationsThatAreARegression) {
  EXPECT_TRUE(has(problems({"method.\"A\".algorithm=linear_regression"}),
                  "algorithm 'linear_regression' needs simulator.name = 'furuta'"));
}

TEST_F(ExternalStudies, OfADatasetCannotBeCalibrated) {
  const std::string dataset = "simulator.dataset=" + (folder_ / "d.h5").string();
  const std::vector<std::string> small = {"diagnose.checks=[\"sbc\", \"tarp\"]", dataset,
                                          "method.num_simulations=2", "method.num_rounds=1"};
  EXPECT_TRUE(has(problems(small),
                  "diagnose.checks = [sbc, tarp], must be such that one of them "
                  "means something to a method"));
}

TEST_F(ExternalStudies, NeedAnObservationOrAWholeTruth) {
  EXPECT_TRUE(says(problems({"target.observation=none.csv"}),
                   {"target.observation = 'none.csv'", "must be an existing CSV or HDF5 file"}));
  EXPECT_EQ(problems({"target.truth={ a = 0.5 }", "simulator.features=[\"peak\"]"}),
            "target.truth: 'b' is missing: a command has no nominal values");
  EXPECT_TRUE(
      has(problems({"target.truth={ a = 0.5, b = 0.0 }"}), "simulator.features is missing"));
  EXPECT_TRUE(
      has(problems({"target.truth={ a = 0.5, b = 0.0, c = 1.0 }", "simulator.features=[\"peak\"]"}),
          "unknown parameter 'c'"));
}

TEST_F(ExternalStudies, HaveNoNeighborsThatNoiseCouldBeCorrelatedWith) {
  EXPECT_EQ(problems({"observation_noise.scale=0.1"}), "");
  EXPECT_TRUE(says(problems({"observation_noise.scale=0.1", "observation_noise.correlation=0.5"}),
                   {"--set observation_noise.correlation=0.5",
                    "must be left out: the simulator gives features"}));
  EXPECT_TRUE(says(
      problems({"observation_noise.scale=0.1", "observation_noise.correlation_prior=[0.5, 1.5]"}),
      {"--set observation_noise.correlation_prior",
       "must be left out: the simulator gives features"}));
}

TEST_F(ExternalStudies, HaveNamesThatCanHeadAColumn) {
  EXPECT_TRUE(
      has(problems({"simulator.features=[\"pe,ak\", \"mean\"]"}), "'pe,ak', must be made of"));
  EXPECT_TRUE(has(problems({"simulator.features=[\"mean\", \"mean [m]\"]"}), "there once"));
  EXPECT_TRUE(
      has(problems({"simulator.parameters={ \"a b\" = 1.0 }"}), "the name 'a b' must be made"));
  EXPECT_TRUE(has(problems({"prior.\"2x\"={ uniform = [0, 1] }"}), "the name '2x' must be made"));
}

TEST_F(ExternalStudies, SeeFeaturesAsTheyAre) {
  const auto embedding = [&](const std::vector<std::string>& overrides) {
    return plan_of(overrides).study.methods.front().embedding;
  };
  EXPECT_EQ(embedding({}).kind, inference::EmbeddingKind::identity);
  EXPECT_EQ(embedding({}).principal_components, 0);
  EXPECT_EQ(embedding({"method.embedding.principal_components=3"}).principal_components, 3)
      << "of two features: all of them";
}

TEST_F(ExternalStudies, TakeTheObservationAsItIs) {
  const Plan plan = plan_of({"observation_noise.scale=0.5"});
  const auto embedding =
      inference::make_embedding(plan.study.methods.front().embedding, plan.target, 1);
  EXPECT_EQ(Observation(plan.study, plan.target).x_o(*embedding), (VectorF(2) << 1, 2).finished());
}

TEST_F(ExternalStudies, KnowTheFeaturesThatAnEmbeddingMayPick) {
  EXPECT_EQ(plan_of({"method.embedding.channels=[\"mean\"]"}).nodes.size(), plan_of().nodes.size());
  EXPECT_TRUE(has(problems({"method.embedding.channels=[\"men\"]"}),
                  "unknown feature 'men' (did you mean 'mean'?)"));
}

TEST_F(ExternalStudies, AnEditOfTheScriptOrASettingMakesOtherSimulations) {
  const auto key_of = [&](const std::vector<std::string>& overrides = {}) {
    return plan_of(overrides).node(Stage::simulate, {"A", 1, 1}).key;
  };
  const std::string key = key_of();
  EXPECT_EQ(key_of({"study.name=other"}), key);
  EXPECT_EQ(
      key_of({"target.truth={ a = 0.5, b = 0.0 }", "simulator.features=[\"peak [m]\", \"mean\"]"}),
      key)
      << "simulations of the prior know nothing of the target";
  EXPECT_NE(key_of({"simulator.time_limit=10"}), key);
  EXPECT_NE(key_of({"simulator.command=sh ./sim.sh"}), key);
  EXPECT_NE(key_of({"simulator.parameters={ c = 1.0 }"}), key);
  EXPECT_NE(key_of({"simulator.features=[\"mean\", \"peak [m]\"]"}), key);
  folder_.file("sim.sh", "exit 1");
  EXPECT_NE(key_of(), key);
}

TEST_F(ExternalStudies, AllPosteriorsAreMeasuredInUnitsOfTheSameSimulations) {
  const Plan both = plan_of({"method.\"B\".num_simulations=200"});
  const Plan one = plan_of({"method.\"B\".num_simulations=200"}, {{"B"}, {}});
  const std::string key = both.node(Stage::simulate, {"A", 1, 1}).key;
  for (const Plan* plan : {&both, &one}) {
    const Node& evaluation = plan->node(Stage::evaluate, {"B", 1, 1});
    EXPECT_EQ(evaluation.identity.inputs.at("prior_predictive"), key);
  }
  EXPECT_EQ(one.node(Stage::evaluate, {"B", 1, 1}).key,
            both.node(Stage::evaluate, {"B", 1, 1}).key);
}

TEST_F(ExternalStudies, OfADatasetHaveOneRoundAndItsRows) {
  const std::string dataset = "simulator.dataset=" + (folder_ / "d.h5").string();
  const auto problem = [&](const std::string& more) {
    return message_of<InputError>(
        [&] {
          plan_of({dataset, "method.num_simulations=8", "method.training.batch_size=2",
                   "method.num_atoms=2", "method.training.validation_fraction=0.5", more});
        },
        &folder_);
  };
  EXPECT_TRUE(
      has(problem("method.num_rounds=2"), "method.num_rounds = 2, must be 1 with a dataset"));
  EXPECT_TRUE(
      has(problem("study.name=x"), "num_simulations = 8, must be <= 2, the rows of the dataset"));
  EXPECT_TRUE(has(problem("prior={ c = { uniform = [0, 1] } }"), "has no parameter 'c'"));
  EXPECT_TRUE(has(problem("simulator.parameters={ c = 1 }"),
                  "simulator.parameters must be left out: a dataset can't be simulated again"));
}

// More numbers than are read at once, asked for in any order: x stays with its theta.
TEST_F(ExternalStudies, RowsOfALargeDatasetAreThoseOfTheirTheta) {
  constexpr Index n = 3000, num_features = 200;
  {
    RowMatrix theta(n, 2), x(n, num_features);
    for (Index i = 0; i < n; ++i) {
      theta.row(i).setConstant(static_cast<double>(i) / n);
      x.row(i).setLinSpaced(static_cast<double>(i), static_cast<double>(i + 1));
    }
    h5::File file = h5::File::create(folder_ / "large.h5");
    file.write("theta", theta).set_attribute("labels", std::vector<std::string>{"a", "b"});
    file.write("x", x);
    file.close();
    std::string x_o = "0";
    for (Index f = 1; f < num_features; ++f) x_o += ",0";
    folder_.file("large.csv", x_o + "\n");
  }
  const Plan plan = plan_of({"simulator.dataset=" + (folder_ / "large.h5").string(),
                             "target.observation=" + (folder_ / "large.csv").string(),
                             "prior={ a = { normal = [0, 1] }, b = { normal = [0, 1] } }"});
  const RowMatrix theta = *plan.source->theta(1, n);
  const auto rows = plan.source->open({.simulator = {}, .target = {}, .seed = 1, .num_rows = n});
  for (const Index begin : {0, 64, 2500, 1200, 0, 1300}) {
    const Index count = std::min<Index>(500, n - begin);
    const RowMatrix some = plan.source->parameters().complete(theta.middleRows(begin, count));
    const auto x = rows->simulate(some, {1, "x", 1, static_cast<std::uint64_t>(begin), 0});
    for (Index i = 0; i < count; ++i) {
      EXPECT_NEAR(x.row(i)[0], n * theta(begin + i, 0), 1e-3) << begin << " " << i;
    }
  }
}

}  // namespace
}  // namespace npdr::pipeline
