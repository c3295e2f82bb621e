/// Rows that failed, and rows that single precision can't tell apart: what users are told.
#include "inference/direct_posterior.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/artefacts/schemas.h"
#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

class Failures : public CommandTest {
 protected:
  // A simulator in awk: what it prints for the parameters $1, $2.
  Outcome run_study(const std::string& prints, const std::vector<std::string>& settings) const {
    folder_.file("x_o.csv", "0.5\n");
    folder_.file("s.toml", command_study("failing")
                               .with("simulator", {"command = \"awk -F, 'NR > 1 {" + prints +
                                                   "}' {theta} > {x}\""})
                               .method("NPE", {"algorithm = \"npe_a\"", "num_simulations = 200",
                                               kSmallMixture, "training = { max_epochs = 3 }"})
                               .with("evaluate", {"num_samples = 40"})
                               .with("limits", {"max_failed_fraction = 1.0"}));
    std::vector<std::string> words = {"run", "s.toml"};
    for (const std::string& setting : settings) words.insert(words.end(), {"--set", setting});
    return npdr(words);
  }
  std::string table(const std::string& name) const {
    return text_of(folder_ / "runs/failing/tables" / (name + ".md"));
  }
};

const std::string kFailsAbove = "print ($1 > 0.8 ? \\\"nan\\\" : $1)";

TEST_F(Failures, ThatDependOnParametersAreAVerdict) {
  const Outcome outcome = run_study(kFailsAbove, {"diagnose.checks=['failures']"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::string found = table("diagnostics");
  EXPECT_TRUE(has(found, {"FAILS, p = ", "simulations of round 1 failed; their 'a' is"}));
}

TEST_F(Failures, ThatDependOnParametersAreAWarningWithoutChecks) {
  const auto report_of = [&](const std::string& prints) {
    const Outcome outcome = run_study(prints, {});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return text_of(folder_ / "runs/failing/report.html");
  };
  EXPECT_TRUE(has(report_of(kFailsAbove), "simulations of round 1 failed"));
  EXPECT_FALSE(has(report_of("print (NR % 20 == 0 ? \\\"nan\\\" : $1)"), "failed; their"));
}

TEST_F(Failures, OfAllRowsAreAnError) {
  const Outcome outcome = run_study("print \\\"nan\\\"", {});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(
      has(outcome.err, "all of its 200 rows failed (100 %: 200 diverged): nothing can be learned"));
}

TEST_F(Failures, OfPredictionsAreAVerdict) {
  const std::string prints = "print (system(\\\"test -d fail\\\") == 0 ? \\\"nan\\\" : $1)";
  std::vector<std::string> settings = {"diagnose={ checks = ['predictive'], num_samples = 40 }"};
  const Outcome first = run_study(prints, settings);
  ASSERT_EQ(first.status, 0) << first.err;
  std::filesystem::remove_all(folder_ / "runs/.cache/diagnose");
  std::filesystem::create_directory(folder_ / "fail");  // of a file the study would know
  settings.push_back("report.title=again");
  const Outcome outcome = run_study(prints, settings);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(has(table("diagnostics"), {"FAILS", "40 of 40 predictions failed"}));
}

// Weights that are finite, but no sum of them is.
TEST_F(Failures, OfANetworkAreAnError) {
  MethodConfig method;
  method.density_estimator = {
      .kind = inference::EstimatorKind::maf, .num_transforms = 2, .hidden_features = 8};
  inference::NetworkParts parts{
      .prior = inference::Prior({{"a", "1", inference::Marginal::Kind::uniform, 0.0, 1.0}}),
      .estimator = method.density_estimator,
      .transform = {VectorF::Zero(1), VectorF::Ones(1), {}},
      .parameters = {},
      .x_o = VectorF::Ones(1)};
  const auto network = inference::make_network(parts.estimator, 1, {}, 1, 0);
  parts.parameters.setConstant(network.num_parameters(), 3e38f);
  const Identity identity{key_document(kPosteriorSchema), {}, {{"name", "s"}}, 1};
  ArtefactWriter writer(folder_ / "p.h5", kPosteriorSchema, identity);
  write_posterior(writer.file(), method, inference::DirectPosterior(parts), {}, {}, {}, {});
  writer.finish();
  folder_.file("theta.csv", "a\n0.5\n");
  for (const std::vector<std::string>& words : {std::vector<std::string>{"npdr", "sample", "p.h5"},
                                                {"npdr", "log-prob", "p.h5", "theta.csv"}}) {
    const Outcome outcome = run(folder_.path(), words);
    EXPECT_EQ(outcome.status, 1) << words[1];
    EXPECT_EQ(outcome.out, "") << words[1];
    EXPECT_TRUE(has(outcome.err, "isn't a number"));
  }
}

}  // namespace
}  // namespace npdr::pipeline
