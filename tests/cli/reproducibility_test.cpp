#include <cstdlib>

#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

class Reproducibility : public SmallStudyTest {
 protected:
  // Digests of a whole run into a work folder of its own.
  std::map<std::string, std::string> digests_of(const std::string& work,
                                                const std::vector<std::string>& more) {
    std::vector<std::string> words = {"run", "small.toml", "--work", work};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = npdr(words);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return digests(folder_.path() / work / "small");
  }
};

TEST_F(Reproducibility, SameBitsForAnyThreadCountAndShardSize) {
  setenv("OMP_NUM_THREADS", "1", 1);
  const auto reference = digests_of("one", {"--jobs", "1"});
  setenv("OMP_NUM_THREADS", "3", 1);
  const auto threads = digests_of("three", {"--jobs", "3"});
  const auto shards = digests_of("shards", {"--set", "simulate.shard_size=37"});
  unsetenv("OMP_NUM_THREADS");
  EXPECT_EQ(reference.size(), 16u);  // target, baseline, and 2 x (2 x 3 + 1) of the methods
  EXPECT_EQ(threads, reference);
  EXPECT_EQ(shards, reference);
}

TEST_F(Reproducibility, SameBitsOfAPool) {
  std::ofstream(folder_.path() / "small.toml")
      << pendulum_study("small")
             .with("observation_noise", {"scale = 0.1"})
             .method("NPE and NLE",
                     {"algorithm = \"npe_nle\"", "num_rounds = 2", "num_simulations = 150",
                      "embedding = { kind = \"all_steps\", downsample = 20, "
                      "principal_components = 4 }",
                      kSmallFlow, "training = { max_epochs = 30 }"})
             .with("evaluate", {"num_samples = 600"});
  setenv("OMP_NUM_THREADS", "1", 1);
  const auto reference = digests_of("one", {"--jobs", "1"});
  setenv("OMP_NUM_THREADS", "3", 1);
  const auto threads = digests_of("three", {"--jobs", "3", "--set", "simulate.shard_size=37"});
  unsetenv("OMP_NUM_THREADS");
  EXPECT_EQ(reference.size(), 9u);  // target, baseline, and 2 x 3 + 1 of the method
  EXPECT_EQ(threads, reference);
}

TEST_F(Reproducibility, SameBitsOfTheMinigolf) {
  std::ofstream(folder_.path() / "small.toml") << small_minigolf_study();
  setenv("OMP_NUM_THREADS", "1", 1);
  const auto reference = digests_of("one", {"--jobs", "1", "--set", "simulate.shard_size=64"});
  setenv("OMP_NUM_THREADS", "3", 1);
  const auto threads = digests_of("three", {"--jobs", "3", "--set", "simulate.shard_size=1000"});
  unsetenv("OMP_NUM_THREADS");
  EXPECT_EQ(reference.size(), 10u);  // target, held_out, baseline, and 2 x 3 + 1 of the method
  EXPECT_EQ(threads, reference);
}

// One method of each kind without a network, each with a distance of its own.
std::string abc_study() {
  return furuta_study("small")
      .with("target", {"truth = { pole_length = 0.09 }"})
      .with("simulator", {"store_every = 25"})
      .only("prior",
            {"pole_length = { uniform = [0.065, 0.194] }", "gravity = { uniform = [8.34, 11.28] }"})
      .with("observation_noise", {"scale = 0.1"})
      .method("SMC", {"algorithm = \"abc_smc\"", "num_rounds = 2", "num_simulations = 150",
                      "abc = { quantile = 0.2, smooth = true }"})
      .method("MCMC", {"algorithm = \"abc_mcmc\"", "num_rounds = 2", "num_simulations = 150",
                       "abc = { distance = \"dtw\" }"})
      .method("Regression", {"algorithm = \"linear_regression\""})
      .method("Refined", {"algorithm = \"refine\"",
                          "refine = { start = \"SMC\", level_size = 1000, min_ess = 100, "
                          "max_simulations = 4000 }"})
      .with("evaluate", {"num_samples = 30", "metrics = [\"rmse\"]"});
}

TEST_F(Reproducibility, SameBitsWithoutNetworks) {
  std::ofstream(folder_.path() / "small.toml") << abc_study();
  setenv("OMP_NUM_THREADS", "1", 1);
  const auto reference = digests_of("one", {"--jobs", "1", "--set", "simulate.shard_size=64"});
  setenv("OMP_NUM_THREADS", "3", 1);
  const auto threads = digests_of("three", {"--jobs", "3"});
  unsetenv("OMP_NUM_THREADS");
  // target, baseline, 2 x (2 x 3 + 1), and 2 of the regression and the refinement each
  EXPECT_EQ(reference.size(), 20u);
  EXPECT_EQ(threads, reference);

  const auto sample = [&](const std::string& method, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"npdr", "sample", "-n", "20",
                                      "one/small/" + method + "/infer.h5"};
    words.insert(words.end(), more.begin(), more.end());
    return run(folder_.path(), words);
  };
  for (const char* method :
       {"smc/seed-1/round-2", "mcmc/seed-1/round-2", "regression/seed-1/round-1"}) {
    const Outcome samples = sample(method, {});
    EXPECT_EQ(samples.status, 0) << samples.err;
    std::ofstream(folder_.path() / "theta.csv") << samples.out;
    const Outcome densities =
        npdr({"log-prob", std::string("one/small/") + method + "/infer.h5", "theta.csv"});
    EXPECT_EQ(densities.status, 0) << densities.err;
    EXPECT_FALSE(has(densities.out, "nan"));
    const Outcome other = sample(method, {"--x", "one/small/target.h5"});
    EXPECT_EQ(other.status, 2);
    EXPECT_TRUE(has(other.err, "has no network and holds for its own observation alone"));
  }
}

TEST_F(Reproducibility, AnotherSeedGivesOtherBits) {
  const auto first = digests_of("a", {});
  const auto second = digests_of("b", {"--set", "study.seeds=[2]"});
  EXPECT_NE(first.at("npdr-maf/seed-1/round-2/infer.h5"),
            second.at("npdr-maf/seed-2/round-2/infer.h5"));
}

TEST_F(Reproducibility, ASecondRunDoesNothing) {
  digests_of("runs", {});
  const Outcome again = npdr({"run", "small.toml", "--dry-run"});
  EXPECT_EQ(again.out, "");
}

TEST_F(Reproducibility, AChangedTrainingKeyKeepsTheSimulationsOfRoundOne) {
  digests_of("runs", {});
  const Outcome plan =
      npdr({"run", "small.toml", "--dry-run", "--set", "method.training.learning_rate=2e-3"});
  EXPECT_FALSE(has(plan.out, "# simulate NPDR (MAF), seed 1, round 1"));
  EXPECT_TRUE(has(
      plan.out, {"# infer NPDR (MAF), seed 1, round 1", "# simulate NPDR (MAF), seed 1, round 2"}));
}

TEST_F(Reproducibility, VerifyRecomputesRowsBitForBit) {
  digests_of("runs", {});
  for (const char* artefact : {"simulate", "propose"}) {
    const Outcome outcome =
        npdr({"verify", std::string("runs/small/npdr-maf/seed-1/round-1/") + artefact + ".h5"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(has(outcome.out, "10 of 150 rows recomputed, 0 differ"));
  }
}

}  // namespace
}  // namespace npdr::pipeline
