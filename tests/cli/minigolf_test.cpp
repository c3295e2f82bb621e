#include "pipeline/artefacts/recording.h"
#include "tests/cli/study_run.h"

namespace npdr::pipeline {
namespace {

// A quick version of the mini golf, from the first draw to the report.
class MinigolfStudy : public StudyRun {
 protected:
  static void SetUpTestSuite() { run_study("small.toml", small_minigolf_study()); }

  static h5::File open(const std::string& name) {
    return h5::File::open(folder_->path() / "runs/small" / name);
  }
  static std::string text(const std::string& name) {
    return text_of(folder_->path() / "runs/small" / name);
  }
  // A metric of a baseline point.
  static double baseline(const std::string& point, const std::string& metric) {
    const h5::File file = open("baseline.h5");
    const std::vector<std::string> names = file.dataset("name").read<std::string>();
    const auto found = std::find(names.begin(), names.end(), point);
    EXPECT_NE(found, names.end()) << point;
    return file.dataset(metric).read<double>().at(std::size_t(found - names.begin()));
  }
};

TEST_F(MinigolfStudy, HoldsRolloutsOutOfTheTarget) {
  EXPECT_EQ(read_recording(folder_->path() / "runs/small/target.h5", std::nullopt).num_rollouts(),
            2);
  const Target rest = read_recording(folder_->path() / "runs/small/held_out.h5", std::nullopt);
  ASSERT_EQ(rest.num_rollouts(), 1);
  EXPECT_EQ(rest.rollouts.front().name, "simulated 2");
}

TEST_F(MinigolfStudy, TheTruthExplainsHeldOutRolloutsToo) {
  for (const char* metric : {"rmse", "held_out_rmse", "final_error", "held_out_final_error"}) {
    EXPECT_LT(baseline("truth", metric), 1e-6) << metric;
    EXPECT_GT(baseline("nominal", metric), 1e-3) << metric;
  }
}

// The reference differs from nominal in the ball's mass, which changes nothing.
TEST_F(MinigolfStudy, MeasuresReferences) {
  EXPECT_NEAR(baseline("heavy", "held_out_rmse"), baseline("nominal", "held_out_rmse"), 1e-6);
  const h5::File file = open("npdr-maf/seed-1/round-2/evaluate.h5");
  EXPECT_EQ(file.dataset("reference/name").read<std::string>(), std::vector<std::string>{"heavy"});
  EXPECT_EQ(file.dataset("reference/log_prob").read<double>(),
            file.dataset("nominal_log_prob").read<double>());
}

TEST_F(MinigolfStudy, ReportsWhatItMeasured) {
  const std::string fit = text("tables/fit.md");
  EXPECT_TRUE(
      has(fit, {"| RMSE, held out ", "| Final error [m] ",
                "| P(rests within 5 cm of the hole), held out ", " nominal ", " heavy ", " truth ",
                "of the target's own rollouts 0 of 2, of the held-out ones 0 of 1"}));
  EXPECT_TRUE(has(text("tables/seeds.md"), "log p(heavy)"));
  EXPECT_TRUE(has(text("tables/contraction.md"), "| obstacle2_dyaw"));
  EXPECT_TRUE(has(text("tables/parameters.md"), "modulo 3.142"));
  EXPECT_TRUE(has(text("figures/paths.svg"), ">held out<"));
}

TEST_F(MinigolfStudy, GoalsAreForSimulatorsThatHaveOne) {
  std::ofstream(folder_->path() / "pendulum.toml") << small_study();
  EXPECT_TRUE(has(npdr(2, {"validate", "pendulum.toml", "--set", "evaluate.metrics=['goal']"}).err,
                  "the simulator 'pendulum' has no goal"));
}

}  // namespace
}  // namespace npdr::pipeline
