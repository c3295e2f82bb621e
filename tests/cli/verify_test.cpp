// Artefacts that are made again to be compared.
#include "tests/cli/study_run.h"

namespace npdr::pipeline {
namespace {

constexpr const char* kPosterior = "runs/again/a/seed-1/round-1/infer.h5";

class VerifyByRemake : public StudyRun {
 protected:
  static void SetUpTestSuite() {
    run_study("again.toml",
              pendulum_study("again").method(
                  "A", {"num_simulations = 100", "embedding = { kind = \"bayessim\" }",
                        kSmallMixture, "training = { max_epochs = 3 }"}),
              {"--until", "infer"});
  }
};

TEST_F(VerifyByRemake, APosteriorIsTrainedAgainToTheSameBits) {
  const auto before = digests(*folder_ / "runs");
  const Outcome outcome = npdr(0, {"verify", kPosterior, "--remake", "again.toml"});
  EXPECT_EQ(outcome.out, std::string(kPosterior) + ": made again, with the same bits\n");
  EXPECT_TRUE(says(outcome.err, {"npdr verify: makes again infer A, seed 1, round 1, which took ",
                                 "core-seconds"}));
  EXPECT_EQ(digests(*folder_ / "runs"), before);
}

// A file that says that it is the posterior.
TEST_F(VerifyByRemake, AnotherPosteriorUnderTheSameKeyIsFound) {
  const std::filesystem::path other = *folder_ / "other.h5";
  {
    const h5::File made = h5::File::open(*folder_ / kPosterior);
    const ArtefactInfo info = read_artefact_info(*folder_ / kPosterior);
    ArtefactWriter writer(other, info.schema, info.identity);
    writer.file().set_attribute("algorithm", std::string("npe"));
    writer.finish();
  }
  EXPECT_EQ(npdr(1, {"verify", "other.h5", "--remake", "again.toml"}).out,
            "other.h5: made again, with OTHER bits\n");
}

TEST_F(VerifyByRemake, TheStudyMustBeTheFilesOwn) {
  EXPECT_TRUE(says(npdr(2, {"verify", kPosterior, "--remake", "again.toml", "--set",
                            "method.training.learning_rate=0.002"})
                       .err,
                   {"npdr verify: key '", "is not in the plan of this study", "--set changed"}));
  const Outcome elsewhere =
      npdr(2, {"verify", kPosterior, "--remake", "again.toml", "--work", "elsewhere"});
  EXPECT_TRUE(says(elsewhere.err,
                   {"npdr verify: infer A, seed 1, round 1 needs 'target', which isn't there"}));
  EXPECT_FALSE(std::filesystem::exists(*folder_ / "elsewhere"));
}

}  // namespace
}  // namespace npdr::pipeline
