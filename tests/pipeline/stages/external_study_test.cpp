/// Studies with a command or a dataset in place of a built-in simulator: problems and keys.
#include "pipeline/artefacts/dataset_file.h"
#include "pipeline/features/observation.h"
#include "pipeline/plan/plan.h"
#include "tests/pipeline/small_study.h"
#include "tests/pipeline/store/written_h5.h"
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

class ExternalStudies : public FolderTest {
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
};

TEST_F(ExternalStudies, HaveDefaultsOfTheirOwn) {
  const Study study = study_of();
  EXPECT_EQ(study.evaluate.metrics, std::vector<Metric>{Metric::distance});
  EXPECT_FALSE(study.evaluate.floor);
  EXPECT_EQ(study.external.folder, folder_.path().string() + "/");
  EXPECT_EQ(study_of({"simulator.dataset=" + (folder_ / "d.h5").string()}).external.command,
            std::nullopt);
  const Plan plan = plan_of({"observation_noise.scale=0.5"});
  EXPECT_EQ(plan.study.external.features, (std::vector<std::string>{"peak [m]", "mean"}));
  const inference::EmbeddingConfig& config = plan.study.methods.front().embedding;
  EXPECT_EQ(config.kind, inference::EmbeddingKind::identity);
  EXPECT_EQ(config.principal_components, 0);
  const auto embedding = inference::make_embedding(config, plan.target, 1);
  EXPECT_EQ(Observation(plan.study, plan.target).x_o(*embedding), (VectorF(2) << 1, 2).finished())
      << "without noise";
}

TEST_F(ExternalStudies, SimulationsOfThePriorKnowNothingOfTheTarget) {
  const auto key_of = [&](const std::vector<std::string>& overrides = {}) {
    return plan_of(overrides).node(Stage::simulate, {"A", 1, 1}).key;
  };
  const std::string key = key_of();
  EXPECT_EQ(
      key_of({"target.truth={ a = 0.5, b = 0.0 }", "simulator.features=[\"peak [m]\", \"mean\"]"}),
      key);
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

// More numbers than are read at once, asked for in any order: x stays with its theta.
TEST_F(ExternalStudies, RowsOfALargeDatasetAreThoseOfTheirTheta) {
  constexpr Index n = 3000, num_features = 200;
  written_h5(folder_ / "large.h5", [&](h5::File& file) {
    RowMatrix theta(n, 2), x(n, num_features);
    for (Index i = 0; i < n; ++i) {
      theta.row(i).setConstant(static_cast<double>(i) / n);
      x.row(i).setLinSpaced(static_cast<double>(i), static_cast<double>(i + 1));
    }
    file.write("theta", theta).set_attribute("labels", std::vector<std::string>{"a", "b"});
    file.write("x", x);
  });
  std::string x_o = "0";
  for (Index f = 1; f < num_features; ++f) x_o += ",0";
  folder_.file("large.csv", x_o + "\n");
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
