#include "pipeline/report/verdicts.h"

#include "core/constants.h"
#include "pipeline/report/registry.h"
#include "tests/message_of.h"
#include "tests/pipeline/report/verdict_fixture.h"

namespace npdr::pipeline {
namespace {

TEST_F(Verdicts, AMethodWithoutFaultPassesAll) {
  const auto summaries = check_summaries(data_);
  ASSERT_EQ(summaries.size(), 1u);
  EXPECT_EQ(words_of(summaries.front()), "NPDR (MAF): all 8 checks pass; not checked: Calibration");
  ASSERT_EQ(summaries.front().reasons.size(), 1u);
  EXPECT_TRUE(says(summaries.front().reasons.front(),
                   {"Calibration: it wasn't checked", "[diagnose]", "for each seed 300 more"}));
  plan_.study.places.add("diagnose.checks", {});
  EXPECT_EQ(check_summaries(data_).front().reasons.size(), 0u) << "by choice";
  EXPECT_EQ(words_of(check_summaries(data_).front()), "NPDR (MAF): all 8 checks pass");
  EXPECT_EQ(verdict_of(Check::failures).text, "passes, p = 1");
}

TEST_F(Verdicts, ThatNoRolloutIsHeldOutIsSaidWhereAllElsePasses) {
  plan_.study.methods.front().algorithm.kind = inference::Algorithm::abc_smc;  // has no calibration
  const auto reasons = [&] { return check_summaries(data_).front().reasons; };
  data_.target.rollouts.resize(3, data_.target.rollouts.front());
  EXPECT_EQ(reasons().size(), 0u) << "a simulated truth";
  plan_.study.target.recording = "r.h5";
  ASSERT_EQ(reasons().size(), 1u);
  EXPECT_TRUE(
      says(reasons().front(), {"Held-out rollouts: there are none", "target.held_out = 1"}));
  plan_.study.evaluate.leave_out = 3;
  EXPECT_EQ(reasons().size(), 0u);
}

TEST_F(Verdicts, ThatFirstStatesHaveNoiseIsSaidWhereAllElsePasses) {
  plan_.study.places.add("diagnose.checks", {});
  plan_.study.target.recording = "r.h5";
  plan_.study.observation_noise.scale = 0.01;
  const auto num_reasons = [&] { return check_summaries(data_).front().reasons.size(); };
  EXPECT_EQ(num_reasons(), 0u) << "it stands still";
  RowMatrix& states = data_.target.rollouts.front().states;
  for (Index t = 0; t < states.rows(); ++t) states.row(t).setConstant(0.1 * static_cast<double>(t));
  ASSERT_EQ(num_reasons(), 1u);
  EXPECT_TRUE(says(check_summaries(data_).front().reasons.front(),
                   {"First states: ", "refine.infer_first_states = true"}));
  plan_.study.target.recording.reset();
  EXPECT_EQ(num_reasons(), 0u) << "a simulated truth";
}

TEST_F(Verdicts, APosteriorAtTheEndOfThePriorPressesAgainstIt) {
  add_run(samples_around(1.75, 0.02), 0.02);
  const Verdict found = verdict_of(Check::bounds);
  EXPECT_EQ(found.judgment, Judgment::fails);
  EXPECT_NE(found.reason.find("pole_mass at 1.7 kg, pole_length at 1.7 m"), std::string::npos)
      << found.reason;
  plan_.study.prior.front().unit = "1";
  const Verdict without_unit = verdict_of(Check::bounds);
  EXPECT_NE(without_unit.reason.find("pole_mass at 1.7, pole_length"), std::string::npos)
      << without_unit.reason;
}

TEST_F(Verdicts, DensityThatHasLeakedIsHeldBackByTheCombinedLoss) {
  RowMatrix theta = samples_around(1.0, 0.02);
  theta.col(0).head(20).setConstant(1.7);  // 5 %
  theta.col(0).tail(20).setConstant(0.3);
  add_run(theta, 0.02);
  inference::AlgorithmConfig& algorithm = plan_.study.methods.front().algorithm;
  algorithm.kind = inference::Algorithm::npe_c;
  algorithm.num_rounds = 2;
  const Verdict found = verdict_of(Check::bounds);
  EXPECT_EQ(found.judgment, Judgment::fails);
  EXPECT_TRUE(found.reason.ends_with("leaked there: try combined_loss = true")) << found.reason;
  EXPECT_NE(found.reason.find("pole_mass at 0.3 kg, pole_mass at 1.7 kg;"), std::string::npos);
  const auto names_remedy = [&] {
    return verdict_of(Check::bounds).reason.find("combined_loss") != std::string::npos;
  };
  algorithm.combined_loss = true;
  EXPECT_FALSE(names_remedy());
  algorithm.combined_loss = false;
  algorithm.num_rounds = 1;
  EXPECT_FALSE(names_remedy()) << "maximum likelihood";
  algorithm.num_rounds = 2;
  plan_.study.methods.front().density_estimator.kind = inference::EstimatorKind::mdn;
  EXPECT_FALSE(names_remedy()) << "the analytic loss";
}

// A correlation of 400 samples that don't depend on each other has a standard error of 0.05.
TEST_F(Verdicts, ACombinationThatAloneIsKnownIsSaid) {
  RowMatrix theta = samples_around(1.0, 0.2);
  add_run(theta, 0.02);
  EXPECT_EQ(verdict_of(Check::contraction).reason, "");
  theta.col(1) = 2.0 - theta.col(0).array() + 0.2 * (theta.col(1).array() - 1.0);
  add_run(theta, 0.02);
  const Verdict found = verdict_of(Check::contraction);
  EXPECT_EQ(found.judgment, Judgment::passes);
  EXPECT_TRUE(says(found.reason, {"of pole_mass and pole_length it knows little but a combination",
                                  "correlation -0.98", "record motion"}));
  add_run((1.0 + 0.1 * (theta.array() - 1.0)).matrix(), 0.02);
  EXPECT_EQ(verdict_of(Check::contraction).reason, "") << "each is known by itself";
}

// Of 1000 draws of the prior some 5 are within three deviations of 0.02 of both parameters.
TEST_F(Verdicts, APosteriorWhereHardlyAnySimulationsLieAsksForRounds) {
  inference::AlgorithmConfig& algorithm = plan_.study.methods.front().algorithm;
  algorithm.kind = inference::Algorithm::npe_nle;
  algorithm.num_rounds = 1;
  algorithm.num_simulations = 1000;
  const auto reason_around = [&](double deviation) {
    add_run(samples_around(1.0, deviation), 0.02);
    return verdict_of(Check::contraction).reason;
  };
  EXPECT_TRUE(says(reason_around(0.02), {"only about 5 of 1000 simulations lie where it is:",
                                         "num_rounds = 4 and num_simulations = 250"}));
  EXPECT_TRUE(says(reason_around(0.002), {"hardly any of 1000 simulations lie where it is"}));
  EXPECT_EQ(reason_around(0.1), "");
  algorithm.num_simulations = 100'000;
  EXPECT_EQ(reason_around(0.02), "") << "there are enough";
  algorithm.num_simulations = 1000;
  algorithm.num_rounds = 2;
  EXPECT_EQ(reason_around(0.02), "");
}

TEST_F(Verdicts, SeedsAtOppositeEndsOfThePriorAreBothSaid) {
  add_run(samples_around(1.75, 0.02), 0.02);
  data_.runs.push_back(data_.runs.front());
  data_.runs.back().use.seed = 2;
  data_.runs.back().evaluation.theta.col(0) = samples_around(0.25, 0.02).col(0);
  const Verdict found = verdict_of(Check::bounds);
  EXPECT_TRUE(found.text.ends_with("in 2 of 2 seeds")) << found.text;
  EXPECT_NE(found.reason.find("pole_mass at 0.3 kg, pole_mass at 1.7 kg, pole_length at 1.7 m;"),
            std::string::npos)
      << found.reason;
}

TEST_F(Verdicts, ParametersWhoseSamplesAllLieOnABoundArentKnown) {
  RowMatrix theta = samples_around(1.0, 0.02);
  theta.col(1).setConstant(1.7);
  add_run(theta, 0.02);
  EXPECT_TRUE(data_.is_inferred(kMethod, 1));
  EXPECT_EQ(verdict_of(Check::bounds).judgment, Judgment::fails);
  theta.col(1).setConstant(1.2);
  add_run(theta, 0.02);
  EXPECT_FALSE(data_.is_inferred(kMethod, 1));
  EXPECT_EQ(verdict_of(Check::bounds).judgment, Judgment::passes);
}

TEST_F(Verdicts, APosteriorThatIsThePriorSaysNothing) {
  const inference::Prior prior(plan_.study.prior);
  add_run(sample_prior(prior, 400, 1), 0.02);
  EXPECT_EQ(verdict_of(Check::contraction).text, "it IS the prior");
  EXPECT_EQ(verdict_of(Check::bounds).judgment, Judgment::passes);
  // A posterior that contracts by a quarter is told from it (false alarms: 1e-3; fixed seed).
  RowMatrix narrower = sample_prior(prior, 400, 1);
  narrower.col(0) = 1.0 + std::sqrt(0.75) * (narrower.col(0).array() - 1.0);
  add_run(narrower, 0.02);
  EXPECT_EQ(verdict_of(Check::contraction).judgment, Judgment::passes);
  EXPECT_NE(verdict_of(Check::contraction).reason.find("says little of pole_length"),
            std::string::npos);
}

// Half of the samples at either end of the prior: wider than it.
TEST_F(Verdicts, APosteriorOfTwoModesSaysMoreThanThePrior) {
  RowMatrix theta = sample_prior(inference::Prior(plan_.study.prior), 400, 1);
  theta.col(0) = (theta.col(0).array() > 1.0).select(Vector::Constant(400, 1.6), 0.4);
  theta.col(0) += 0.05 * theta.col(1);
  add_run(theta, 0.02);
  EXPECT_EQ(verdict_of(Check::contraction).judgment, Judgment::passes);
  EXPECT_EQ(verdict_of(Check::contraction).reason, "says little of pole_length");
}

// A recording for whose noise a study has no word is the commonest reason of all.
TEST_F(Verdicts, APredictionThatFailsNamesTheNoiseThatTheStudyLacks) {
  inference::PredictiveCheck& check = data_.diagnoses.back().result.predictive->check;
  check.p_value = 1e-6;
  check.summary_p_value = Vector::Constant(1, 1e-6);
  data_.diagnoses.back().result.predictive->names = {"mean"};
  data_.diagnoses.back().result.predictive->observed = Vector::Ones(1);
  const auto reason = [&] { return verdict_of(Check::predictive).reason; };
  EXPECT_TRUE(says(reason(), {"what its samples predict is unlike the observation",
                              "simulator or noise lack something, or more simulations"}))
      << "a simulated target has none";
  plan_.study.target.recording = "recording.h5";
  EXPECT_TRUE(says(reason(), {"what its samples predict is unlike the observation",
                              "observation_noise.scale, or scale_prior to infer it"}));
  plan_.study.observation_noise.scale = 0.1;
  EXPECT_TRUE(says(reason(), {"what its samples predict is unlike the observation",
                              "(observation_noise.scale_prior, correlation, degrees_of_freedom)"}));
}

TEST_F(Verdicts, TrainingFailsFarAboveItsLossAndAtItsLastEpoch) {
  inference::TrainingCheck& training = *data_.diagnoses.front().result.training;
  training.generalization_gap = 5.3;
  EXPECT_EQ(verdict_of(Check::training).text, "converged, gap 5.3 nats: FAR above training");
  EXPECT_NE(verdict_of(Check::training).reason.find("more of them, or a smaller network"),
            std::string::npos);
  training = {};
  training.num_epochs = plan_.study.method(kMethod).training.max_epochs;
  training.recent_fall = 0.8;
  EXPECT_NE(verdict_of(Check::training)
                .reason.find("the validation loss fell by 0.8 nats in the "
                             "last tenth of the epochs; raise it"),
            std::string::npos);
  training.recent_fall = 0.0;
  training.generalization_gap = 6.0;
  EXPECT_NE(verdict_of(Check::training).reason.find("lies 6 nats above that of training"),
            std::string::npos)
      << "more epochs won't mend that";
}

TEST_F(Verdicts, ChecksThatCouldFindNothingCantTell) {
  Diagnosis& diagnosis = data_.diagnoses.front().result;
  diagnosis.ood->num_reference = 20;
  diagnosis.predictive->check.overall.num_reference = 20;
  add_run(samples_around(1.0, 0.02).topRows(99), 0.02);
  EXPECT_EQ(words_of(check_summaries(data_).front()),
            "NPDR (MAF): 4 of 8 checks pass; can't tell: Posterior predictive, x_o among "
            "simulations, Bounds of the prior, Contraction");
  EXPECT_NE(verdict_of(Check::ood).reason.find("raise method.num_simulations"), std::string::npos);
  EXPECT_TRUE(verdict_of(Check::predictive).reason.ends_with("; raise diagnose.num_samples"));
  diagnosis.num_samples = 200;
  diagnosis.predictive->num_failed = 132;
  EXPECT_TRUE(says(
      verdict_of(Check::predictive).reason,
      {"132 of 200 samples failed in the simulator; 20 predictions", "mend the simulator there"}));
  diagnosis.ood.reset();
  EXPECT_EQ(verdict_of(Check::ood).judgment, Judgment::unknown);
}

TEST_F(Verdicts, NothingIsInfinitelyFar) {
  auto& ood = *data_.diagnoses.front().result.ood;
  ood.p_value = 1e-5;
  ood.mahalanobis = {3.0, 1.5, 0.1};
  ood.residual = {kInfinity, 0.0, 1e-5};
  const Verdict found = verdict_of(Check::ood);
  EXPECT_EQ(found.judgment, Judgment::fails);
  EXPECT_NE(found.reason.find(
                "2 times the usual distance within the simulations' directions, and "
                "a feature that in all of them has another value, or one far farther from 0"),
            std::string::npos)
      << found.reason;
  EXPECT_EQ(found.reason.find("inf"), std::string::npos);
}

TEST_F(Verdicts, TheTableHasThemAll) {
  data_.diagnoses.front().result.ood->p_value = 1e-5;
  const analysis::Table table = diagnostics_table().make(data_);
  EXPECT_EQ(table.rows.size(), 8u);
  EXPECT_EQ(table.footnotes.size(), 1u);
  EXPECT_EQ(table.rows[1].label, "x_o among simulations");
  EXPECT_EQ(table.rows[1].cells.front().notes, std::vector<std::size_t>{0});
}

}  // namespace
}  // namespace npdr::pipeline
