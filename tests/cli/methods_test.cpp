#include "tests/cli/study_run.h"

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

// All by one thread.
class Methods : public StudyRun {
 protected:
  static void SetUpTestSuite() {
    const OmpThreads one(1);
    run_study("all.toml", all_algorithms_study(), {"-j", "1"});
  }
};

TEST_F(Methods, EveryAlgorithmRunsWithTheSameBitsForAnyThreadCount) {
  const OmpThreads three(3);
  npdr(0, {"run", "all.toml", "--work", "three", "-j", "3"});
  const auto reference = digests(file("runs/all"));
  EXPECT_EQ(reference.size(), 37u);  // target, baseline, and 5 x (2 x 3 + 1) of the methods
  EXPECT_EQ(digests(file("three/all")), reference);
}

TEST_F(Methods, TheTableOfSeedsSaysHowWellChainsAgree) {
  std::ifstream seeds(file("runs/all/tables/seeds.csv"));
  std::string header, npe_a, npe_b, nle;
  for (std::string* line : {&header, &npe_a, &npe_b, &nle}) std::getline(seeds, *line);
  EXPECT_TRUE(header.ends_with("largest R-hat,smallest ESS")) << header;
  EXPECT_TRUE(npe_a.ends_with(",,")) << npe_a;
  EXPECT_FALSE(nle.ends_with(",")) << nle;
  EXPECT_TRUE(
      has(text_of(file("runs/all/tables/proposals.md")), {"| prior", "| npe_a, 2", "| nle, 2"}));
}

TEST_F(Methods, PosteriorsOfALikelihoodCanBeSampledFromTheCommandLine) {
  const std::string posterior = "runs/all/nle/seed-1/round-2/infer.h5";
  const Outcome samples = npdr(0, {"sample", posterior, "-n", "5"});
  EXPECT_EQ(std::ranges::count(samples.out, '\n'), 6) << samples.out;
  EXPECT_TRUE(samples.err.starts_with("chains: largest R-hat ")) << samples.err;
  EXPECT_TRUE(has(npdr(0, {"sample", posterior, "-n", "5", "--x", "runs/all/target.h5"}).err,
                  "warning: " + posterior + " is of round 2"));
}

TEST_F(Methods, SamplesThatRepeatOthersAreCounted) {
  std::ofstream(file("abc.toml")) << pendulum_study("abc")
                                         .with("observation_noise", {"scale = 0.1"})
                                         .method("ABC", {"algorithm = \"abc_rejection\"",
                                                         "num_simulations = 100",
                                                         "embedding = { kind = \"last_step\" }",
                                                         "abc = { quantile = 0.2 }"});
  npdr(0, {"run", "abc.toml", "--until", "infer"});
  const Outcome samples = npdr(0, {"sample", "abc.toml", "-n", "500"});
  EXPECT_TRUE(samples.err.starts_with("note: 480 of 500 rows repeat others: ")) << samples.err;
}

}  // namespace
}  // namespace npdr::pipeline
