// Verdicts on what posteriors' samples predict.
#include "pipeline/report/verdicts.h"

#include "core/random.h"
#include "tests/message_of.h"
#include "tests/pipeline/report/verdict_fixture.h"

namespace npdr::pipeline {
namespace {

TEST_F(Verdicts, RoundsGoOnFromACalibratedOneAlone) {
  add_run(samples_around(1.0, 0.02), 0.5);
  EXPECT_TRUE(verdict_of(Check::fit).reason.ends_with(", more rounds"));
  plan_.study.diagnose.checks.push_back(Check::sbc);
  data_.diagnoses.back().result.sbc.emplace().test.p_value = 1e-9;
  EXPECT_TRUE(verdict_of(Check::fit).reason.ends_with("whose calibration FAILS: mend that first"))
      << verdict_of(Check::fit).reason;
}

TEST_F(Verdicts, AnErrorFarAboveTheFloorFails) {
  data_.baseline.points = {{"floor", Vector(), {{"rmse", 0.1}}}};
  add_run(samples_around(1.0, 0.02), 0.29);
  EXPECT_EQ(verdict_of(Check::fit).text, "passes, 2.9 times the floor's");
  add_run(samples_around(1.0, 0.02), 3.0);
  EXPECT_EQ(verdict_of(Check::fit).judgment, Judgment::fails);
  plan_.study.methods.front().embedding.kind = inference::EmbeddingKind::last_step;
  EXPECT_NE(verdict_of(Check::fit)
                .reason.find("30 times the floor's: try embedding.principal_components without"),
            std::string::npos);
  plan_.study.methods.front().embedding.kind = inference::EmbeddingKind::convolution;
  EXPECT_NE(verdict_of(Check::fit).reason.find("30 times the floor's: try more simulations"),
            std::string::npos)
      << "what it has already";
}

// A noise that is inferred takes up what the simulator lacks, and every check passes.
TEST_F(Verdicts, AFloorFarAboveTheScatterOfARecordingIsSaid) {
  plan_.study.target.recording = "recording.h5";
  Stream stream({5, "verdicts_test", 0, 0, 0});
  auto& states = data_.target.rollouts.front().states;
  for (double& value : states.reshaped()) value += 0.004 * stream.normal();
  data_.baseline.points = {{"floor", Vector(), {{"rmse", 0.02}}}};
  EXPECT_EQ(verdict_of(Check::fit).reason, "");
  data_.baseline.points = {{"floor", Vector(), {{"rmse", 0.04}}}};
  EXPECT_EQ(verdict_of(Check::fit).judgment, Judgment::passes);
  EXPECT_TRUE(says(verdict_of(Check::fit).reason,
                   {"no parameters explain the recording better than the floor's 0.04", "10 times",
                    "what neighboring samples scatter by", "the simulator lacks something"}));
  plan_.study.observation_noise.correlation_prior = {0.5, 1.0};
  EXPECT_EQ(verdict_of(Check::fit).reason, "") << "it may be noise";
}

TEST_F(Verdicts, WhatARefinementWouldFindIsSaid) {
  plan_.study.target.recording = "recording.h5";
  data_.baseline.points = {{"floor", Vector(), {{"rmse", 0.04}}}};
  add_run(samples_around(1.0, 0.02), 0.1);
  EXPECT_TRUE(says(verdict_of(Check::fit).reason,
                   {"its samples are 2.5 times as far from the recording as the best parameters",
                    "algorithm = \"refine\"", "refine.start = \"NPDR (MAF)\""}));
  add_run(samples_around(1.0, 0.02), 0.07);
  EXPECT_EQ(verdict_of(Check::fit).reason, "");
}

TEST_F(Verdicts, AFloorFarAboveTheNoiseIsSaid) {
  data_.baseline.points = {{"floor", Vector(), {{"rmse", 0.4}}}};
  add_run(samples_around(1.0, 0.02), 0.45);
  plan_.study.observation_noise.scale = 0.15;
  EXPECT_EQ(verdict_of(Check::fit).reason, "");
  plan_.study.observation_noise.scale = 0.02;
  EXPECT_EQ(verdict_of(Check::fit).judgment, Judgment::passes);
  EXPECT_TRUE(says(verdict_of(Check::fit).reason,
                   {"no parameters explain the observation better than the floor's 0.4, 20 times "
                    "the noise: raise observation_noise towards it"}));
  plan_.study.observation_noise.correlation = 0.999;
  EXPECT_EQ(verdict_of(Check::fit).reason, "") << "it adds up to far more";
  plan_.study.observation_noise = {};
  EXPECT_EQ(verdict_of(Check::fit).reason, "") << "a simulated target";
  plan_.study.target.recording = "recording.h5";
  EXPECT_TRUE(says(verdict_of(Check::fit).reason,
                   {"no parameters explain the recording better than the floor's 0.4 of its "
                    "largest magnitudes",
                    "what the simulator lacks"}));
  const auto asks_for_more = [&] {
    return verdict_of(Check::fit).reason.find("target.held_out") != std::string::npos;
  };
  EXPECT_FALSE(asks_for_more()) << "one rollout";
  plan_.target.rollouts.resize(2);
  EXPECT_TRUE(asks_for_more());
  plan_.study.target.held_out = 1;
  EXPECT_FALSE(asks_for_more());
  plan_.study.observation_noise.std = {{"theta", 0.3}};
  EXPECT_EQ(verdict_of(Check::fit).reason, "") << "noise is stated, by channel";
  plan_.study.observation_noise.std = {{"theta", 0.01}};
  EXPECT_TRUE(says(verdict_of(Check::fit).reason,
                   {"no parameters explain the observation better", "80 times the noise"}));
  plan_.study.observation_noise.std = {{"theta", 3.0}};
  EXPECT_TRUE(says(verdict_of(Check::fit).reason,
                   {"the best parameters leave 0.4 of the recording, the noise is 4 times"}));
  const auto overstates = [&] {
    return verdict_of(Check::fit).reason.find("the best parameters leave") != std::string::npos;
  };
  EXPECT_TRUE(overstates());
  plan_.study.observation_noise.correlation = 0.5;
  EXPECT_FALSE(overstates()) << "its mean over a segment is part of what they explain";
  plan_.study.observation_noise.correlation.reset();
  plan_.study.observation_noise.degrees_of_freedom = 2.5;
  EXPECT_FALSE(overstates()) << "heavy tails";
  plan_.study.observation_noise.degrees_of_freedom.reset();
  plan_.study.target.recording.reset();
  EXPECT_FALSE(overstates()) << "a simulated target, whose noise is what it says";
  plan_.study.target.recording = "recording.h5";
  plan_.study.observation_noise.std.reset();
  data_.baseline.points = {{"floor", Vector(), {{"rmse", 0.04}}}};
  data_.runs.front().evaluation.metrics["rmse"].setConstant(0.045);
  EXPECT_EQ(verdict_of(Check::fit).reason, "") << "as sensors may leave";
}

TEST_F(Verdicts, SamplesAsFarOffAsThePriorsFail) {
  data_.baseline.points = {{"floor", Vector(), {{"rmse", 0.1}}}};
  add_run(samples_around(1.0, 0.02), 0.1);
  Vector& rmse = data_.runs.front().evaluation.metrics["rmse"];
  rmse.head(20).setConstant(1.1);  // of 400; the prior's are 1
  EXPECT_EQ(verdict_of(Check::fit).judgment, Judgment::passes) << "a few may";
  rmse.head(80).setConstant(1.1);
  EXPECT_EQ(verdict_of(Check::fit).text, "20 % of its samples are FAR off");
  EXPECT_TRUE(says(verdict_of(Check::fit).reason,
                   {"their RMSE is above 1, the median of the prior's; that of all of them is 0.1",
                    "a mode that isn't there"}));
  // Where the observation tells little, many are.
  data_.baseline.prior->metrics["rmse"].setConstant(0.25);
  EXPECT_EQ(verdict_of(Check::fit).judgment, Judgment::passes);
}

TEST_F(Verdicts, PredictionsThatAreTooNarrowForHeldOutRolloutsFail) {
  plan_.study.target.num_rollouts = 1;
  plan_.study.target.held_out = 1;
  add_run(samples_around(1.0, 0.02), 0.02);
  Index num_compared = 400;
  const auto judge = [&](double covered, double share_as_seldom) {
    PredictionScores& scores = data_.runs.front().evaluation.scores.held_out.emplace();
    scores.coverage = RowMatrix::Zero(std::ssize(kBandLevels), 2);
    scores.noisy_coverage = RowMatrix::Constant(std::ssize(kBandLevels), 2, 1.0);
    scores.noisy_coverage.row(8) << covered - 0.1, covered + 0.1;
    scores.noisy_crps = Vector::Constant(2, 0.11);
    scores.share_as_seldom_within = share_as_seldom;
    scores.num_compared = num_compared;
    return judge_held_out(data_, kMethod);
  };
  EXPECT_EQ(judge(0.8, 0.002).text, "passes, bands of 90 % hold 80 %");
  EXPECT_EQ(judge(0.8, 0.002).reason, "");
  EXPECT_TRUE(says(judge(0.7, 0.002).reason, {"bands of 90 % hold 70 %", "a little too sure"}));
  EXPECT_EQ(judge(0.8, 0.0).text, "predictions are TOO NARROW, bands of 90 % hold 80 %");
  EXPECT_TRUE(says(judge(0.8, 0.0).reason,
                   {"bands of 90 % hold 80 % of rollouts that inference hasn't seen, and more of",
                    "look for what simulator or noise lack"}));
  EXPECT_EQ(judge(0.3, 0.002).judgment, Judgment::unknown);
  EXPECT_EQ(judge(0.3, 0.002).text, "can't tell, bands of 90 % hold 30 %");
  data_.baseline.prior->scores.held_out.emplace().noisy_crps = Vector::Constant(2, 0.1);
  EXPECT_EQ(judge(0.8, 0.002).judgment, Judgment::passes);
  data_.baseline.prior->scores.held_out->noisy_crps.setConstant(0.08);
  EXPECT_EQ(judge(0.8, 0.002).text,
            "predictions are WORSE than the prior's, bands of 90 % hold 80 %");
  EXPECT_TRUE(
      says(judge(0.8, 0.002).reason,
           {"the CRPS of its predictions of rollouts that inference hasn't seen is 0.11, that of "
            "the prior's 0.08: look for"}));
  data_.baseline.points = {{"nominal", Vector(), {}, data_.baseline.prior->scores}};
  data_.baseline.points.front().scores.held_out->noisy_crps.setConstant(0.05);
  EXPECT_EQ(judge(0.8, 0.002).text,
            "predictions are WORSE than the prior's, bands of 90 % hold 80 %")
      << "the nominal parameters may be the truth";
  plan_.study.target.truth.reset();
  EXPECT_EQ(judge(0.8, 0.002).text,
            "predictions are WORSE than the nominal parameters', bands of 90 % hold 80 %");
  data_.baseline.points.clear();
  data_.baseline.prior->scores.held_out.reset();
  plan_.study.target.num_rollouts = 4;
  EXPECT_TRUE(
      says(judge(0.8, 0.0).reason, {"bands of 90 %", "refine it with refine.cross_validate"}));
  plan_.study.methods.front().algorithm.kind = inference::Algorithm::refine;
  EXPECT_TRUE(says(judge(0.8, 0.0).reason,
                   {"bands of 90 %", "let refine.cross_validate choose the power"}));
  plan_.study.methods.front().refine.sampling.cross_validate = true;
  EXPECT_EQ(judge(0.8, 0.0).reason.find("cross_validate"), std::string::npos) << "it does already";
  plan_.study.methods.front().refine.infer_first_states = true;
  EXPECT_EQ(judge(0.8, 0.0).judgment, Judgment::unknown);
  EXPECT_TRUE(says(judge(0.8, 0.0).reason,
                   {"bands of 90 % hold 80 %", "predictions begin in recorded first states"}));
  num_compared = 99;
  EXPECT_EQ(judge(0.8, 0.0).judgment, Judgment::unknown);
  EXPECT_EQ(plan_.study.why_unchecked(Check::held_out, plan_.study.methods.front()), "");
  plan_.study.target.held_out = 0;
  EXPECT_NE(plan_.study.why_unchecked(Check::held_out, plan_.study.methods.front()), "");
}

TEST_F(Verdicts, AnErrorBelowTheNoisePasses) {
  data_.baseline.points = {{"truth", Vector(), {{"rmse", 1e-8}}}};
  plan_.study.observation_noise.scale = 0.2;
  add_run(samples_around(1.0, 0.02), 0.19);
  EXPECT_EQ(verdict_of(Check::fit).text, "passes, 0.95 times the noise");
  add_run(samples_around(1.0, 0.02), 0.22);
  EXPECT_EQ(verdict_of(Check::fit).judgment, Judgment::fails);
}

TEST_F(Verdicts, ARecordingThatNoParametersExplainFails) {
  data_.baseline.points = {{"floor", Vector(), {{"rmse", 0.63}}}};
  add_run(samples_around(1.0, 0.02), 0.64);
  EXPECT_EQ(verdict_of(Check::fit).text, "NO parameters fit, 0.63 at best");
  EXPECT_NE(verdict_of(Check::fit).reason.find("sign and zero of the angles"), std::string::npos);
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
    ASSERT_EQ(judge_fit(data_, kMethod).judgment, Judgment::passes) << trial;
  }
}

// Nothing is as good as a truth without noise: the prior says what is small.
TEST_F(Verdicts, WithoutNoiseTheErrorIsComparedWithThePriors) {
  data_.baseline.points = {{"truth", Vector(), {{"rmse", 1e-8}}}};
  add_run(samples_around(1.0, 0.02), 0.09);
  EXPECT_EQ(verdict_of(Check::fit).text, "passes, 9 % of the prior's");
  add_run(samples_around(1.0, 0.02), 0.2);
  EXPECT_EQ(verdict_of(Check::fit).judgment, Judgment::fails);
}

}  // namespace
}  // namespace npdr::pipeline
