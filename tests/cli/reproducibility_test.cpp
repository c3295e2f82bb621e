#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

class Reproducibility : public CommandTest {
 protected:
  // Of a whole run of a study that is called "small", into the folder "one", and of one by other
  // numbers of threads, jobs and shards.
  void expect_same_bits(const StudyText& study, std::size_t num_artefacts) const {
    folder_.file("small.toml", study);
    const auto digests_of = [&](const std::string& work, const std::string& shard_size) {
      const std::string number = work == "one" ? "1" : "3";
      const OmpThreads threads(std::stoi(number));
      npdr(0, {"run", "small.toml", "--work", work, "--jobs", number, "--set",
               "simulate.shard_size=" + shard_size});
      return digests(folder_ / work / "small");
    };
    const auto reference = digests_of("one", "1000");
    EXPECT_EQ(reference.size(), num_artefacts);
    EXPECT_EQ(digests_of("three", "37"), reference);
  }
};

// target, baseline, and 2 x (2 x 3 + 1) of the methods
TEST_F(Reproducibility, SameBitsForAnyThreadCountAndShardSize) {
  expect_same_bits(small_study(), 16);
}

// target, baseline, and 2 x 3 + 1 of the method
TEST_F(Reproducibility, SameBitsOfAPool) {
  expect_same_bits(
      pendulum_study("small")
          .with("observation_noise", {"scale = 0.1"})
          .method("NPE and NLE",
                  {"algorithm = \"npe_nle\"", "num_rounds = 2", "num_simulations = 150",
                   "embedding = { kind = \"all_steps\", downsample = 20, "
                   "principal_components = 4 }",
                   kSmallFlow, "training = { max_epochs = 30 }"})
          .with("evaluate", {"num_samples = 600"}),
      9);
}

// target, held_out, baseline, and 2 x 3 + 1 of the method
TEST_F(Reproducibility, SameBitsOfTheMinigolf) { expect_same_bits(small_minigolf_study(), 10); }

// One method of each kind without a network, each with a distance of its own.
StudyText abc_study() {
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

// target, baseline, 2 x (2 x 3 + 1), and 2 of the regression and the refinement each
TEST_F(Reproducibility, SameBitsWithoutNetworks) {
  expect_same_bits(abc_study(), 20);
  for (const std::string method :
       {"smc/seed-1/round-2", "mcmc/seed-1/round-2", "regression/seed-1/round-1"}) {
    const std::string posterior = "one/small/" + method + "/infer.h5";
    folder_.file("theta.csv", npdr(0, {"sample", "-n", "20", posterior}).out);
    EXPECT_FALSE(has(npdr(0, {"log-prob", posterior, "theta.csv"}).out, "nan"));
    EXPECT_TRUE(has(npdr(2, {"sample", "-n", "20", posterior, "--x", "one/small/target.h5"}).err,
                    "has no network and holds for its own observation alone"));
  }
}

}  // namespace
}  // namespace npdr::pipeline
