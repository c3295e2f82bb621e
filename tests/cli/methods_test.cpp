#include <cstdlib>

#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

// All algorithms beside NPE-C, in two rounds.
std::string all_algorithms_study() {
  StudyText study = pendulum_study("all")
                        .with("observation_noise", {"scale = 0.1"})
                        .with("evaluate", {"num_samples = 40", "metrics = [\"rmse\"]"});
  for (const auto& [algorithm, kind] : {std::pair{"npe_a", "mdn"},
                                        {"npe_b", "nsf"},
                                        {"nle", "maf"},
                                        {"nre_a", "resnet"},
                                        {"nre_b", "resnet"}}) {
    StudyText::Lines lines = {
        std::string("algorithm = \"") + algorithm + "\"",
        "num_rounds = 2",
        "num_simulations = 60",
        "embedding = { kind = \"all_steps\", downsample = 20, principal_components = 4 }",
        std::string("density_estimator = { kind = \"") + kind +
            "\", num_transforms = 2, num_components = 2, hidden_features = 8 }",
        "training = { max_epochs = 10, batch_size = 20 }"};
    if (!std::string(algorithm).starts_with("npe")) {
      lines.emplace_back(
          "sampler = { num_chains = 10, num_warmup = 10, thin = 2, num_candidates = 100 }");
    }
    study.method(algorithm, lines);
  }
  return study;
}

class Methods : public CommandTest {
 protected:
  Methods() { folder_.file("all.toml", all_algorithms_study()); }
};

TEST_F(Methods, EveryAlgorithmRunsWithTheSameBitsForAnyThreadCount) {
  setenv("OMP_NUM_THREADS", "1", 1);
  const Outcome one = npdr({"run", "all.toml", "--work", "one", "-j", "1"});
  setenv("OMP_NUM_THREADS", "3", 1);
  const Outcome three = npdr({"run", "all.toml", "--work", "three", "-j", "3"});
  unsetenv("OMP_NUM_THREADS");
  ASSERT_EQ(one.status, 0) << one.err;
  ASSERT_EQ(three.status, 0) << three.err;
  const auto reference = digests(folder_.path() / "one" / "all");
  EXPECT_EQ(reference.size(), 37u);  // target, baseline, and 5 x (2 x 3 + 1) of the methods
  EXPECT_EQ(digests(folder_.path() / "three" / "all"), reference);
}

TEST_F(Methods, TheTableOfSeedsSaysHowWellChainsAgree) {
  const Outcome outcome = npdr({"run", "all.toml", "--only", "nle", "--only", "npe_a"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  std::ifstream file(folder_.path() / "runs" / "all" / "tables" / "seeds.csv");
  std::string header, npe_a, nle;
  std::getline(file, header);
  std::getline(file, npe_a);
  std::getline(file, nle);
  EXPECT_TRUE(header.ends_with("largest R-hat,smallest ESS")) << header;
  EXPECT_TRUE(npe_a.ends_with(",,")) << npe_a;
  EXPECT_FALSE(nle.ends_with(",")) << nle;
  const std::string proposals = text_of(folder_.path() / "runs/all/tables/proposals.md");
  EXPECT_TRUE(has(proposals, {"| prior", "| npe_a, 2", "| nle, 2"}));
}

TEST_F(Methods, PosteriorsOfALikelihoodCanBeSampledFromTheCommandLine) {
  const Outcome outcome = npdr({"run", "all.toml", "--only", "nle", "--until", "infer"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::string posterior = "runs/all/nle/seed-1/round-2/infer.h5";
  const Outcome samples = npdr({"sample", posterior, "-n", "5"});
  EXPECT_EQ(samples.status, 0) << samples.err;
  EXPECT_EQ(std::ranges::count(samples.out, '\n'), 6) << samples.out;
  EXPECT_TRUE(samples.err.starts_with("chains: largest R-hat ")) << samples.err;
  const Outcome other = npdr({"sample", posterior, "-n", "5", "--x", "runs/all/target.h5"});
  EXPECT_EQ(other.status, 0) << other.err;
  EXPECT_TRUE(has(other.err, "warning: " + posterior + " is of round 2"));
}

TEST_F(Methods, SamplesThatRepeatOthersAreCounted) {
  std::ofstream(folder_.path() / "abc.toml")
      << pendulum_study("abc")
             .with("observation_noise", {"scale = 0.1"})
             .method("ABC", {"algorithm = \"abc_rejection\"", "num_simulations = 100",
                             "embedding = { kind = \"last_step\" }", "abc = { quantile = 0.2 }"});
  ASSERT_EQ(npdr({"run", "abc.toml", "--until", "infer"}).status, 0);
  const Outcome samples = npdr({"sample", "abc.toml", "-n", "500"});
  EXPECT_EQ(samples.status, 0) << samples.err;
  EXPECT_TRUE(samples.err.starts_with("note: 480 of 500 rows repeat others: ")) << samples.err;
}

}  // namespace
}  // namespace npdr::pipeline
