// Verdicts on posteriors; other words of theirs are in tests/golden/report.txt.
#include "pipeline/findings/findings.h"

#include "core/constants.h"
#include "core/random.h"
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
  const auto found = [&] { return finding_of(Check::bounds); };
  EXPECT_EQ(found().severity, Severity::wrong);
  EXPECT_TRUE(has(found().advice, "combined_loss"));
  EXPECT_TRUE(has(found().what, "pole_mass = 0.3 kg and pole_mass = 1.7 kg"));
  plan_.study.prior.front().unit = "1";
  EXPECT_TRUE(has(found().what, "pole_mass = 0.3 and pole_mass = 1.7"));
  method.algorithm.num_rounds = 1;
  EXPECT_FALSE(has(found().advice, "combined_loss")) << "maximum likelihood";
  method.algorithm.num_rounds = 2;
  method.density_estimator.kind = inference::EstimatorKind::mdn;
  EXPECT_FALSE(has(found().advice, "combined_loss")) << "the analytic loss";
}

// The prior ends at the simulator's own limit, or a little above it.
TEST_F(Verdicts, AnEndWhereTheSimulatorEndsIsNoFault) {
  RowMatrix theta = samples_around(1.0, 0.02);
  theta.col(0) = 0.3 + 0.02 * (theta.col(0).array() - 1.0).abs();
  add_run(theta, 0.02);
  EXPECT_EQ(finding_of(Check::bounds).severity, Severity::wrong);
  const Index p = sim::parameter_index(data_.info, "pole_mass");
  double& limit = data_.info.parameters[static_cast<std::size_t>(p)].lower;
  for (const double near : {0.3, 0.3 - 0.004 * 1.4}) {
    limit = near;
    EXPECT_EQ(finding_of(Check::bounds).severity, Severity::note) << near;
  }
  EXPECT_TRUE(has(finding_of(Check::bounds).what, "pole_mass = 0.3 kg"));
  limit = 0.2;
  EXPECT_EQ(finding_of(Check::bounds).severity, Severity::wrong) << "it can be widened";
  limit = 0.0;
  plan_.study.prior.front().kind = inference::Marginal::Kind::log_uniform;
  EXPECT_EQ(finding_of(Check::bounds).severity, Severity::wrong) << "0 is decades away";
}

// A correlation of 400 samples that don't depend on each other has a standard error of 0.05.
TEST_F(Verdicts, ACombinationThatAloneIsKnownIsSaid) {
  RowMatrix theta = samples_around(1.0, 0.2);
  add_run(theta, 0.02);
  EXPECT_FALSE(remark_of("contraction.ridge"));
  theta.col(1) = 2.0 - theta.col(0).array() + 0.2 * (theta.col(1).array() - 1.0);
  add_run(theta, 0.02);
  const std::optional<Finding> found = remark_of("contraction.ridge");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->severity, Severity::note);
  EXPECT_TRUE(has(found->what, {"pole_mass and pole_length"}));
  EXPECT_TRUE(has(found->evidence, "-0.98"));
  add_run((1.0 + 0.1 * (theta.array() - 1.0)).matrix(), 0.02);
  EXPECT_FALSE(remark_of("contraction.ridge")) << "each is known by itself";
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
  EXPECT_TRUE(has(remark_of("contraction.flat").value().what, "pole_length"));
}

// Half of the samples at either end of the prior: wider than it.
TEST_F(Verdicts, APosteriorOfTwoModesSaysMoreThanThePrior) {
  RowMatrix theta = sample_prior(inference::Prior(plan_.study.prior), 400, 1);
  theta.col(0) = (theta.col(0).array() > 1.0).select(Vector::Constant(400, 1.6), 0.4);
  theta.col(0) += 0.05 * theta.col(1);
  add_run(theta, 0.02);
  EXPECT_LE(finding_of(Check::contraction).severity, Severity::note);
  EXPECT_FALSE(has(remark_of("contraction.flat").value().what, "pole_mass"));
}

TEST_F(Verdicts, NothingIsInfinitelyFar) {
  auto& ood = *data_.diagnoses.front().result.ood;
  ood.p_value = 1e-5;
  ood.mahalanobis = {3.0, 1.5, 0.1};
  ood.residual = {kInfinity, 0.0, 1e-5};
  const Finding found = finding_of(Check::ood);
  EXPECT_EQ(found.severity, Severity::wrong);
  EXPECT_TRUE(has(found.evidence, "a feature has a value that no simulation"));
  EXPECT_FALSE(has(found.evidence, "inf"));
}

// A figure has colors for six methods, of those that have something to draw.
TEST_F(Verdicts, PowersAreDrawnOfASeventhMethod) {
  for (const std::string name : {"2", "3", "4", "5", "6", "7"}) {
    data_.methods.push_back(name);
    data_.runs.push_back(data_.runs.front());
    data_.runs.back().use.method = name;
  }
  EXPECT_FALSE(power_figure(data_));
  PosteriorNotes& notes = data_.runs.back().notes;
  notes.powers.power = Vector{{0.1, 1.0}};
  notes.powers.crps = RowMatrix::Ones(2, 2);
  notes.certificate.emplace().wanted_power = 1.0;
  const std::optional<ReportedFigure> figure = power_figure(data_);
  ASSERT_TRUE(figure);
  EXPECT_TRUE(has(figure->caption, "1 (7)"));
}

TEST_F(Verdicts, TheTableHasThemAll) {
  data_.diagnoses.front().result.ood->p_value = 1e-5;
  const analysis::Table table = diagnostics_table(data_).value();
  EXPECT_EQ(table.rows.size(), 9u);
  EXPECT_EQ(table.footnotes.size(), 1u);
  EXPECT_EQ(table.rows[2].label, "x_o among simulations");
  EXPECT_EQ(table.rows[2].cells.front().notes, table.footnotes);
}

RecordingMisfit misfit_of(double times, bool noise_is_given, double limit) {
  RecordingMisfit misfit;
  misfit.num_rollouts = 1;
  misfit.left = RowMatrix::Constant(10, 2, 1.0);
  misfit.of_noise = RowMatrix::Ones(10, 2);
  misfit.times = times;
  misfit.noise_is_given = noise_is_given;
  misfit.limit = limit;
  return misfit;
}

// A noise that is inferred takes up what the simulator lacks, and every other check passes.
TEST_F(Verdicts, ErrorsBeyondTheNoiseOfARecordingFail) {
  data_.baseline.points = {{"floor", Vector(), {{"rmse", 0.02}}}};
  data_.baseline.misfit = misfit_of(1.1, true, 1.15);
  EXPECT_EQ(finding_of(Check::fit).severity, Severity::fine);
  data_.baseline.misfit = misfit_of(1.9, true, 1.15);
  EXPECT_EQ(finding_of(Check::fit).severity, Severity::wrong);
  EXPECT_EQ(finding_of(Check::fit).id, "fit.misfit");
  EXPECT_TRUE(has(finding_of(Check::fit).evidence, {"1.9 times the stated noise", "1.15"}));
  data_.baseline.misfit->cause = "the device reacted to actions 2 samples late";
  data_.baseline.misfit->change = "actions 2 samples later";
  data_.baseline.misfit->times_of_cause = 1.01;
  EXPECT_EQ(finding_of(Check::fit).id, "fit.cause");
  EXPECT_TRUE(has(finding_of(Check::fit).evidence, "with actions 2 samples later, 1.01"));
  data_.baseline.misfit = misfit_of(9.0, false, 4.0);
  EXPECT_TRUE(has(finding_of(Check::fit).evidence, "9 times the scatter of neighboring samples"));
}

TEST_F(Verdicts, AMisfitSaysWhereTheSimulatorIsWrong) {
  data_.baseline.points = {{"floor", Vector(), {{"rmse", 0.02}}}};
  data_.baseline.misfit = misfit_of(2.0, true, 1.15);
  data_.target.dt = 0.02;  // 200 steps
  data_.baseline.misfit->left.topRows(1) << 8.0, 1.0;
  EXPECT_TRUE(has(finding_of(Check::fit).what, {" in theta of every rollout in the first 0.4 s"}));
  data_.baseline.misfit->left.col(0).setConstant(120.0);
  EXPECT_TRUE(finding_of(Check::fit).what.ends_with(" in theta of every rollout"));
}

TEST_F(Verdicts, WhatFollowsFromACauseIsNotSaid) {
  data_.baseline.points = {{"floor", Vector(), {{"rmse", 0.02}}}};
  data_.baseline.misfit = misfit_of(2.0, true, 1.15);
  Diagnosis& diagnosis = data_.diagnoses.front().result;
  diagnosis.predictive->check.p_value = 1e-9;
  diagnosis.predictive->check.summary_p_value = Vector::Constant(1, 1e-9);
  diagnosis.predictive->names = {"mean"};
  diagnosis.predictive->observed = Vector::Ones(1);
  EXPECT_EQ(finding_of(Check::predictive).severity, Severity::wrong);
  EXPECT_EQ(finding_of(Check::predictive).what, "");
  EXPECT_NE(finding_of(Check::predictive).evidence, "") << "for the table";
  EXPECT_TRUE(has(finding_of(Check::fit).what, ". Posterior predictive fails for the same reason"));
  diagnosis.training->generalization_gap = 9.0;
  diagnosis.ood->p_value = 1e-5;
  EXPECT_EQ(finding_of(Check::fit).what, "");
  EXPECT_TRUE(has(finding_of(Check::ood).what, ". Posterior predictive and RMSE fail for the"));
  const CheckSummary summary = check_summaries(data_).front();
  EXPECT_EQ(summary.failed.size(), 4u);
  ASSERT_EQ(summary.reasons.size(), 2u);
  EXPECT_EQ(summary.reasons.front().id, "ood") << "the cause first";
  EXPECT_EQ(summary.reasons.back().id, "training.gap");
}

// Samples of the exact posterior of a linear model with white noise of N = 2 D + 10 values: the
// rate that the documents tell is below 1e-6; 2000 trials of a fixed seed.
TEST_F(Verdicts, TheErrorOfAnExactPosteriorIsNeverFarAboveTheFloor) {
  constexpr Index dimension = 2, values = 14, num_samples = 200;
  for (std::uint64_t trial = 0; trial < 2000; ++trial) {
    Stream stream({1, "fit_check", 0, trial, 0});
    const auto chi_square = [&](Index degrees) {
      double sum = 0.0;
      for (Index i = 0; i < degrees; ++i) sum += std::pow(stream.normal(), 2);
      return sum;
    };
    const double residual = chi_square(values - dimension);
    Vector rmse(num_samples);
    const auto of = [](double sum) { return 0.1 * std::sqrt(sum / values); };
    for (double& value : rmse) value = of(residual + chi_square(dimension));
    data_.baseline.prior->metrics["rmse"].setZero();
    data_.baseline.points = {{"floor", Vector(), {{"rmse", of(residual)}}}};
    data_.runs.front().evaluation.metrics["rmse"] = rmse;
    ASSERT_LE(finding_of(Check::fit).severity, Severity::note) << trial;
  }
}

class Contradictions : public Verdicts {
 protected:
  EvaluatedRun& add_run_of(const std::string& method, double mean) {
    data_.runs.push_back(data_.runs.front());
    data_.runs.back().use.method = method;
    data_.runs.back().evaluation.theta = samples_around(mean, 0.02);
    return data_.runs.back();
  }
  RowMatrix& add_method(const std::string& name, double mean) {
    data_.methods.push_back(name);
    return add_run_of(name, mean).evaluation.theta;
  }
  void iterate() {
    plan_.study.policy.search.kind = inference::PolicyOptimizerKind::power;
    for (MethodConfig& method : plan_.study.methods) method.num_iterations = 2;
  }
  std::string reason() const {
    std::string words;
    for (const char* id : {"contraction.seeds", "contraction.methods"}) {
      const std::optional<Finding> found = remark_of(id);
      if (found) words += found->what + ", " + found->evidence;
    }
    return words;
  }
};

TEST_F(Contradictions, OfSeedsAreNoneWhereEachHasAnObservationOfItsOwn) {
  data_.seeds = {1, 2};
  add_run_of(kMethod, 1.1).use.seed = 2;  // five deviations off
  EXPECT_NE(reason(), "");
  iterate();
  EXPECT_EQ(reason(), "");
}

TEST_F(Contradictions, OfEachMethodAreSaidByItsFarthestParameter) {
  plan_.study.methods.push_back(plan_.study.methods.front());
  plan_.study.methods.back().name = "Third";
  add_method("NPDR (MoG)", 1.1);
  add_method("Third", 1.1).col(1) = samples_around(1.2, 0.02).col(1);
  EXPECT_TRUE(
      has(reason(),
          {"NPDR (MoG) finds another pole_mass and Third finds another pole_length", "7.1 times"}));
}

// Seeds that lie apart widen what they say together, but not what any of them is sure of.
TEST_F(Contradictions, OfMethodsAreSaidWhereSeedsContradictEachOther) {
  data_.seeds = {1, 2};
  add_method("NPDR (MoG)", 1.07);
  add_run_of("NPDR (MoG)", 1.15).use.seed = 2;
  EXPECT_TRUE(has(reason(), {"NPDR (MoG) finds another pole_mass", "3.9 times"}));
}

TEST_F(Contradictions, ArentThoseOfWhatIsKnownOfSamplesWithoutWidthOrOfLoops) {
  RowMatrix& other = add_method("NPDR (MoG)", 1.1);
  other.col(0).setConstant(0.5);
  EXPECT_EQ(reason(), "") << "taken as known";
  // Samples of a network that extrapolates may all lie on a bound.
  other = samples_around(1.0, 0.02);
  other.col(0).setConstant(0.3);
  EXPECT_EQ(reason(), "");
  other = samples_around(1.1, 0.02);
  iterate();
  EXPECT_EQ(reason(), "");
}

}  // namespace
}  // namespace npdr::pipeline
