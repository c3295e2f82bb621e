/// What `npdr export` writes, and that those open it whom it is for.
#include "pipeline/store/h5.h"
#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

using Names = std::vector<std::string>;

class Export : public CommandTest {
 protected:
  void run_study(const StudyText& study) const {
    std::ofstream(folder_.path() / "study.toml") << study;
    npdr(0, {"run", "study.toml", "--until", "evaluate"});
  }
  h5::File exported(const Names& options = {}) const {
    EXPECT_EQ(npdr(0, joined({"export", "study.toml", "-o", "out.nc"}, options)).out,
              "wrote out.nc\n");
    return h5::File::open(folder_ / "out.nc");
  }
};

TEST_F(Export, SeedsAreChainsAndRolloutsArePredicted) {
  run_study(small_study().with("study", {"seeds = [3, 5]"}));
  const h5::File file = exported({"--only", "NPDR (MAF)", "--predictions", "4"});
  EXPECT_EQ(file.names(), (Names{"constant_data", "observed_data", "posterior",
                                 "posterior_predictive", "prior", "sample_stats"}));
  EXPECT_EQ(file.attribute<std::string>("method"), "NPDR (MAF)");
  const h5::Group posterior = file.group("posterior");
  EXPECT_EQ(posterior.names(), (Names{"chain", "draw", "pole_length", "pole_mass"}));
  EXPECT_EQ(posterior.attribute<std::string>("inference_library"), "npdr");
  for (const char* name : {"created_at", "inference_library_version"}) {
    EXPECT_TRUE(posterior.has_attribute(name)) << name;
  }
  EXPECT_EQ(posterior.dataset("chain").read<std::int64_t>(), (std::vector<std::int64_t>{3, 5}));
  const h5::Dataset length = posterior.dataset("pole_length");
  EXPECT_EQ(length.shape(), (h5::Shape{2, 50}));
  EXPECT_EQ(length.attribute<std::string>("units"), "m");
  const RowMatrix theta = h5::File::open(folder_ / "runs/small/npdr-maf/seed-5/round-2/evaluate.h5")
                              .read_matrix<double>("theta");
  const std::vector<double> values = length.read<double>();
  EXPECT_EQ(Vector(Eigen::Map<const Vector>(values.data() + 50, 50)), Vector(theta.col(1)));
  EXPECT_EQ(file.group("sample_stats").names(), (Names{"chain", "draw", "dtw", "lp", "rmse"}));
  EXPECT_EQ(file.group("posterior_predictive").dataset("theta_dot").shape(),
            (h5::Shape{2, 4, 2, 400}));
  EXPECT_EQ(file.group("observed_data").dataset("theta").shape(), (h5::Shape{2, 400}));
  EXPECT_EQ(file.group("constant_data").names(), (Names{"dt", "rollout", "time", "torque"}));
  const std::string study = text_of(folder_ / "study.toml");
  for (const Names& words : {Names{"out.nc"}, {"study.toml"}, {"study.toml", "--force"}}) {
    const Names all = {"export", "study.toml", "--only", "NPDR (MAF)", "-o"};
    EXPECT_TRUE(says(npdr(2, joined(all, words)).err,
                     {"npdr export: " + words.front() + ":",
                      words.size() < 2 ? "add --force" : "an HDF5 file, which alone"}));
  }
  EXPECT_EQ(text_of(folder_ / "study.toml"), study) << "it would be lost";
  EXPECT_TRUE(says(npdr(2, {"export", "study.toml", "--method", "NPDR (MAF)", "-o", "out.csv"}).err,
                   {"npdr export: out.csv: would hold NetCDF", "call it .nc"}));
}

TEST_F(Export, ParticlesKeepTheirWeightsInAGroupOfTheirOwn) {
  run_study(pendulum_study("particles")
                .with("study", {"seeds = [1, 2]"})
                .method("ABC", {"algorithm = \"abc_smc\"", "num_rounds = 2", "num_simulations = 60",
                                "abc = { quantile = 0.5 }"})
                .with("evaluate", {"num_samples = 20"}));
  const h5::File file = exported({"--predictions", "0"});
  EXPECT_FALSE(file.has("posterior_predictive"));
  const h5::Group weighted = file.group("weighted_posterior");
  EXPECT_EQ(weighted.names(), (Names{"chain", "draw", "log_weight", "pole_length", "pole_mass"}));
  double sum = 0.0;
  for (const double value : weighted.dataset("log_weight").read<double>()) sum += std::exp(value);
  EXPECT_NEAR(sum, 2.0, 1e-12);
}

TEST_F(Export, FeaturesStandInPlaceOfRollouts) {
  const Names small = {"shell.toml",
                       "--set",
                       "method.num_simulations=100",
                       "--set",
                       "evaluate.num_samples=30",
                       "--set",
                       "method.training.max_epochs=3"};
  fs::copy(fs::path(NPDR_SOURCE_DIR) / "experiments/external", folder_.path(),
           fs::copy_options::recursive);
  npdr(0, joined({"run", "--until", "evaluate"}, small));
  npdr(0, joined({"export", "-o", "out.nc"}, small));
  const h5::File file = h5::File::open(folder_ / "out.nc");
  EXPECT_EQ(file.names(),
            (Names{"observed_data", "posterior", "posterior_predictive", "prior", "sample_stats"}));
  EXPECT_EQ(file.group("posterior_predictive").dataset("x").shape(), (h5::Shape{1, 30, 2}));
  EXPECT_EQ(file.dataset("observed_data/x").shape(), h5::Shape{2});
}

TEST_F(Export, SaysWhatIsMissing) {
  std::ofstream(folder_.path() / "study.toml") << small_study();
  EXPECT_TRUE(
      says(npdr(2, {"export", "study.toml", "-o", "out.nc"}).err,
           {"npdr export: small: 2 methods have posteriors (NPDR (MAF), NPDR (MoG))", "--method"}));
  EXPECT_TRUE(
      says(npdr(2, {"export", "study.toml", "-o", "out.nc", "--only", "NPDR (MAF)"}).err,
           {"npdr export: evaluate NPDR (MAF), seed 1, round 2: isn't there yet; run it first:",
            "npdr run study.toml --only 'NPDR (MAF)'"}));
  EXPECT_FALSE(fs::exists(folder_ / "out.nc"));
}

// Needs a network that has these programs and, the first time, a minute to fetch them.
TEST_F(Export, OpensInArvizAndXarray) {
  run_study(small_study().with("study", {"seeds = [3, 5]"}));
  exported({"--only", "NPDR (MAF)", "--predictions", "4"});
  const Outcome outcome =
      run(folder_.path(), {NPDR_SOURCE_DIR "/tests/cli/open_export",
                           NPDR_BINARY_DIR "/tests/cli/open_export.venv", "out.nc"});
  if (outcome.status == 77) GTEST_SKIP() << outcome.err;
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
}

}  // namespace
}  // namespace npdr::pipeline
