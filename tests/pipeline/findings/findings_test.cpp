#include "pipeline/findings/findings.h"

#include "core/constants.h"
#include "pipeline/report/registry.h"
#include "tests/message_of.h"
#include "tests/pipeline/findings/findings_fixture.h"

namespace npdr::pipeline {
namespace {

TEST_F(Verdicts, DensityThatHasLeakedIsHeldBackByTheCombinedLoss) {
  RowMatrix theta = samples_around(1.0, 0.02);
  theta.col(0).head(20).setConstant(1.7);  // 5 %
  theta.col(0).tail(20).setConstant(0.3);
  add_run(theta, 0.02);
  MethodConfig& method = plan_.study.methods.front();
  method.algorithm.kind = inference::Algorithm::npe_c;
  method.algorithm.num_rounds = 2;
  const auto words = [&] { return finding_of(Check::bounds).what; };
  EXPECT_EQ(finding_of(Check::bounds).severity, Severity::wrong);
  EXPECT_TRUE(words().ends_with("leaked there: try combined_loss = true")) << words();
  EXPECT_TRUE(has(words(), "pole_mass at 0.3 kg, pole_mass at 1.7 kg;"));
  plan_.study.prior.front().unit = "1";
  EXPECT_TRUE(has(words(), "pole_mass at 0.3, pole_mass at 1.7;"));
  method.algorithm.num_rounds = 1;
  EXPECT_FALSE(has(words(), "combined_loss")) << "maximum likelihood";
  method.algorithm.num_rounds = 2;
  method.density_estimator.kind = inference::EstimatorKind::mdn;
  EXPECT_FALSE(has(words(), "combined_loss")) << "the analytic loss";
}

// A correlation of 400 samples that don't depend on each other has a standard error of 0.05.
TEST_F(Verdicts, ACombinationThatAloneIsKnownIsSaid) {
  RowMatrix theta = samples_around(1.0, 0.2);
  add_run(theta, 0.02);
  EXPECT_EQ(finding_of(Check::contraction).what, "");
  theta.col(1) = 2.0 - theta.col(0).array() + 0.2 * (theta.col(1).array() - 1.0);
  add_run(theta, 0.02);
  const Finding found = finding_of(Check::contraction);
  EXPECT_LE(found.severity, Severity::note);
  EXPECT_TRUE(says(found.what, {"of pole_mass and pole_length it knows little but a combination",
                                "correlation -0.98", "record motion"}));
  add_run((1.0 + 0.1 * (theta.array() - 1.0)).matrix(), 0.02);
  EXPECT_EQ(finding_of(Check::contraction).what, "") << "each is known by itself";
}

TEST_F(Verdicts, ParametersWhoseSamplesAllLieOnABoundArentKnown) {
  RowMatrix theta = samples_around(1.0, 0.02);
  theta.col(1).setConstant(1.7);
  add_run(theta, 0.02);
  EXPECT_TRUE(data_.is_inferred(kMethod, 1));
  EXPECT_EQ(finding_of(Check::bounds).severity, Severity::wrong);
  theta.col(1).setConstant(1.2);
  add_run(theta, 0.02);
  EXPECT_FALSE(data_.is_inferred(kMethod, 1));
  EXPECT_LE(finding_of(Check::bounds).severity, Severity::note);
}

// A posterior that contracts by a quarter is told from the prior (false alarms: 1e-3; fixed seed).
TEST_F(Verdicts, APosteriorThatContractsByAQuarterIsntThePrior) {
  RowMatrix narrower = sample_prior(inference::Prior(plan_.study.prior), 400, 1);
  narrower.col(0) = 1.0 + std::sqrt(0.75) * (narrower.col(0).array() - 1.0);
  add_run(narrower, 0.02);
  EXPECT_LE(finding_of(Check::contraction).severity, Severity::note);
  EXPECT_TRUE(has(finding_of(Check::contraction).what, "says little of pole_length"));
}

// Half of the samples at either end of the prior: wider than it.
TEST_F(Verdicts, APosteriorOfTwoModesSaysMoreThanThePrior) {
  RowMatrix theta = sample_prior(inference::Prior(plan_.study.prior), 400, 1);
  theta.col(0) = (theta.col(0).array() > 1.0).select(Vector::Constant(400, 1.6), 0.4);
  theta.col(0) += 0.05 * theta.col(1);
  add_run(theta, 0.02);
  EXPECT_LE(finding_of(Check::contraction).severity, Severity::note);
  EXPECT_EQ(finding_of(Check::contraction).what, "says little of pole_length");
}

TEST_F(Verdicts, NothingIsInfinitelyFar) {
  auto& ood = *data_.diagnoses.front().result.ood;
  ood.p_value = 1e-5;
  ood.mahalanobis = {3.0, 1.5, 0.1};
  ood.residual = {kInfinity, 0.0, 1e-5};
  const Finding found = finding_of(Check::ood);
  EXPECT_EQ(found.severity, Severity::wrong);
  EXPECT_TRUE(has(found.what,
                  "2 times the usual distance within the simulations' directions, and "
                  "a feature that in all of them has another value, or one far farther from 0"));
  EXPECT_FALSE(has(found.what, "inf"));
}

TEST_F(Verdicts, TheTableHasThemAll) {
  data_.diagnoses.front().result.ood->p_value = 1e-5;
  const analysis::Table table = diagnostics_table(data_).value();
  EXPECT_EQ(table.rows.size(), 8u);
  EXPECT_EQ(table.footnotes.size(), 1u);
  EXPECT_EQ(table.rows[1].label, "x_o among simulations");
  EXPECT_EQ(table.rows[1].cells.front().notes, table.footnotes);
}

}  // namespace
}  // namespace npdr::pipeline
