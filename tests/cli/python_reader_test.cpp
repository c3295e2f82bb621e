/// The readers of posterior files in python/ say what the program says.
#include <fmt/format.h>

#include "pipeline/artefacts/schemas.h"
#include "pipeline/store/h5.h"
#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

const fs::path kSources = NPDR_SOURCE_DIR;

// A method of each kind of file, with what the readers must undo: trained layers, principal
// components, a division by a proposal.
StudyText study_of_all_kinds() {
  const std::string some = "num_simulations = 300";
  const std::string components =
      "embedding = { kind = \"all_steps\", downsample = 20, principal_components = 4 }";
  const std::string network =
      "\", num_networks = 2, num_transforms = 3, num_components = 3, num_bins = 5, hidden_features "
      "= 12 }";
  const auto estimator = [&](const std::string& kind) {
    return "density_estimator = { kind = \"" + kind + network;
  };
  const std::string training = "training = { max_epochs = 30, batch_size = 50 }";
  // A narrow posterior leaves less of single precision.
  const std::string few_epochs = "training = { max_epochs = 10, batch_size = 50 }";
  const std::string sampler = "sampler = { kind = \"importance\" }";
  return pendulum_study("all")
      .with("observation_noise", {"scale = 0.1"})
      .only("prior",
            {"pole_mass = { log_uniform = [0.3, 1.7] }", "pole_length = { uniform = [0.3, 1.7] }",
             "damping = { log_normal = [-3.0, 1.0] }", "gravity = { normal = [9.81, 0.1] }"})
      .with("evaluate", {"num_samples = 20"})
      .method("maf", {some, training, estimator("maf"),
                      "embedding = { kind = \"linear\", features = 8, downsample = 20, "
                      "principal_components = 1000 }"})  // all that there are
      .method("nsf", {"algorithm = \"npe_c\"", some, few_epochs, estimator("nsf"),
                      "embedding = { kind = \"convolution\", downsample = 20 }"})
      .method("series pool", {some, few_epochs, estimator("nsf"),
                              "embedding = { kind = \"convolution\", downsample = 20 }"})
      .method("mean", {"algorithm = \"npe_c\"", some, few_epochs, estimator("nsf"),
                       "embedding = { downsample = 10, average_rollouts = true }"})
      .method("items", {"algorithm = \"npe_c\"", some, few_epochs, estimator("nsf"),
                        "embedding = { downsample = 80, average_rollouts = true }"})  // 5 steps
      .method("pool", {"algorithm = \"npe_nle\"", some, training, estimator("nsf"), components})
      .method("features", {"algorithm = \"npe_nle\"", some, few_epochs, estimator("nsf"),
                           "embedding = { kind = \"all_steps\", downsample = 200 }"})
      .method("mdn", {"algorithm = \"npe_c\"", some, training, estimator("mdn"),
                      "embedding = { kind = \"bayessim\" }"})
      .method("npe_a", {"algorithm = \"npe_a\"", "num_rounds = 2", some, training,
                        "density_estimator = { kind = \"mdn\", num_components = 3 }", components})
      .method("nle", {"algorithm = \"nle\"", some, training, estimator("maf"), components, sampler})
      .method("nre", {"algorithm = \"nre_b\"", some, training,
                      "density_estimator = { kind = \"resnet\", hidden_features = 12 }", components,
                      sampler})
      .method("abc", {"algorithm = \"abc_rejection\"", some, components,
                      "abc = { quantile = 0.2, smooth = true }"});
}

TEST(PythonReaderText, NamesTheSchemaOfPosteriors) {
  EXPECT_TRUE(has(text_of(kSources / "python/npdr_posterior.py"),
                  fmt::format("\nSCHEMA = {}  #", kPosteriorSchema.version)));
}

class PythonReader : public ::testing::Test {
 protected:
  void SetUp() override {
    python_ = python_with("h5py");
    if (python_.empty()) GTEST_SKIP() << "needs h5py";
  }

  Outcome shell(const std::string& command) const {
    const std::string path = "export OPENBLAS_NUM_THREADS=1 PATH=" NPDR_BINARY_DIR "/bin:$PATH\n";
    return run(folder_.path(), {"/bin/bash", "-c", path + command});
  }

  void run_study(const StudyText& study) const {
    std::ofstream(folder_.path() / "study.toml") << study;
    const Outcome outcome = shell("npdr run study.toml --until infer");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
  }

  void expect_reads(const std::string& posterior) const {
    const Outcome outcome =
        shell("set -e; npdr sample " + posterior + " -n 1000 > theta.csv; npdr log-prob " +
              posterior + " theta.csv > log_prob.csv; " + python_ + " " +
              (kSources / "tests/cli/python_reader.py").string() + " " +
              (kSources / "python").string() + " " + posterior + " theta.csv log_prob.csv");
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  }

  std::string python_;
  TempFolder folder_;
};

TEST_F(PythonReader, SaysWhatTheProgramSaysOfEveryKind) {
  run_study(study_of_all_kinds());
  for (const std::string method :
       {"maf", "nsf", "series-pool", "pool", "features", "mdn", "npe-a", "nle", "nre", "abc"}) {
    const std::string round = method == "npe-a" ? "2" : "1";
    expect_reads("runs/all/" + method + "/seed-1/round-" + round + "/infer.h5");
  }
}

TEST_F(PythonReader, CompressesFeaturesThatSpanOrdersOfMagnitude) {
  std::ofstream theta(folder_.path() / "theta.csv"), x(folder_.path() / "x.csv");
  theta << "a\n";
  x << "plain,wide\n";
  for (int i = 0; i < 300; ++i) {
    const double a = (i + 0.5) / 300.0;
    theta << a << "\n";
    x << std::cos(7.0 * i) + a << "," << std::exp(9.0 * a + std::sin(5.0 * i)) << "\n";
  }
  theta.close();
  x.close();
  std::ofstream(folder_.path() / "x_o.csv") << "plain,wide\n0.5,80\n";
  ASSERT_EQ(shell("npdr import --theta theta.csv --x x.csv -o d.h5").status, 0);
  std::ofstream(folder_.path() / "study.toml")
      << "[study]\nname = 'wide'\n[simulator]\ndataset = 'd.h5'\n[target]\nobservation = "
         "'x_o.csv'\n[prior]\na = { uniform = [0.0, 1.0] }\n[[method]]\nname = 'pool'\n"
         "num_simulations = 300\ntraining = { max_epochs = 20, batch_size = 50 }\n"
         "density_estimator = { num_networks = 2, num_transforms = 2, hidden_features = 12 }\n";
  const Outcome outcome = shell("npdr run study.toml --until infer");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::string posterior = "runs/wide/pool/seed-1/round-1/infer.h5";
  const h5::File file = h5::File::open(folder_.path() / posterior);
  const auto scale = file.dataset("transform/inverse_scale").read<float>();
  ASSERT_EQ(scale.size(), 2u);
  EXPECT_EQ(scale[0], 0.0f);
  EXPECT_GT(scale[1], 0.0f);
  EXPECT_EQ(file.dataset("transform/mean").read<float>().size(), 3u) << "with a copy";
  expect_reads(posterior);
}

TEST_F(PythonReader, ReadsWhatARefinementWeighs) {
  run_study(pendulum_study("refined")
                .with("simulator", {"store_every = 40", "segment_length = 200"})
                .with("observation_noise", {"scale = 0.2"})
                .method("refined",
                        {"algorithm = \"refine\"", "refine = { level_size = 1000, min_ess = 200 }"})
                .with("evaluate", {"num_samples = 20"}));
  expect_reads("runs/refined/refined/seed-1/round-1/infer.h5");
}

TEST_F(PythonReader, TheLinesOfAReportRun) {
  std::ofstream(folder_.path() / "study.toml")
      << pendulum_study("one")
             .method("a flow", {"num_simulations = 100", "training = { max_epochs = 1 }"})
             .with("evaluate", {"num_samples = 20"});
  const Outcome outcome =
      shell("npdr run study.toml > /dev/null && " + python_ + " " +
            (kSources / "tests/cli/report_lines.py").string() + " runs/one/report.html");
  EXPECT_EQ(outcome.out, "(1000, 2) pole_length pole_mass\n") << outcome.err;
}

TEST_F(PythonReader, RefusesWhatItCantRead) {
  run_study(pendulum_study("one").method(
      "maf", {"num_simulations = 100", "training = { max_epochs = 1 }", kSmallFlow}));
  const auto expect_says = [&](const std::string& module, const std::string& name,
                               const std::string& file, const std::string& message) {
    const std::string found = shell("cd " + (kSources / "python").string() + " && " + python_ +
                                    " -B -c 'import " + module + "; " + module + "." + name +
                                    "(\"" + (folder_.path() / file).string() + "\")'")
                                  .err;
    EXPECT_TRUE(has(found, message));
  };
  expect_says("npdr_posterior", "Posterior", "runs/one/target.h5",
              "target.h5: not a trained posterior of schema " +
                  std::to_string(kPosteriorSchema.version) + "; npdr run makes one");
  expect_says("npdr_particles", "Particles", "runs/one/maf/seed-1/round-1/infer.h5",
              "infer.h5: holds no particles; read it by npdr_posterior.py");
}

}  // namespace
}  // namespace npdr::pipeline
