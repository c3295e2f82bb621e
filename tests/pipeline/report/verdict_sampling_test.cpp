// Verdicts on how posteriors were sampled.
#include "pipeline/report/registry.h"
#include "pipeline/report/verdicts.h"
#include "tests/message_of.h"
#include "tests/pipeline/report/verdict_fixture.h"

namespace npdr::pipeline {
namespace {

TEST_F(Verdicts, ChainsThatDontAgreeFail) {
  plan_.study.methods.front().algorithm.kind = inference::Algorithm::nle;
  const auto sampled = [&](double r_hat) {
    data_.runs.front().evaluation.sampler = {Vector::Constant(2, r_hat), Vector::Constant(2, 500),
                                             1};
    return verdict_of(Check::sampling);
  };
  EXPECT_EQ(sampled(1.02).text, "passes, R-hat 1.020");
  EXPECT_EQ(sampled(1.2).text, "chains DON'T agree, R-hat 1.200");
  EXPECT_EQ(sampled(std::nan("")).judgment, Judgment::unknown);
  EXPECT_EQ(words_of(check_summaries(data_).front()),
            "NPDR (MAF): 7 of 8 checks pass; can't tell: Sampling");
}

TEST_F(Verdicts, FewDrawsThatCountFail) {
  plan_.study.methods.front().algorithm.kind = inference::Algorithm::nre_b;
  const auto weighed = [&](double size) {
    data_.runs.front().evaluation.sampler = {Vector(), Vector::Constant(1, size), 1};
    return verdict_of(Check::sampling);
  };
  EXPECT_EQ(weighed(150.0).text, "passes, effective size 150");
  EXPECT_EQ(weighed(37.0).judgment, Judgment::fails);
}

TEST_F(Verdicts, PooledNetworksThatContradictEachOtherFail) {
  EXPECT_EQ(verdict_of(Check::sampling).text, "passes") << "no feature varies";
  const auto pooled = [&](double at_x_o) {
    data_.runs.front().notes.pool = PoolNotes{{0.9, 0.8}, {0.95, at_x_o}, 0.0};
    return verdict_of(Check::sampling);
  };
  EXPECT_EQ(pooled(0.8).text, "passes");
  EXPECT_EQ(pooled(0.8).reason, "");
  EXPECT_EQ(pooled(0.3).text, "passes");
  EXPECT_EQ(pooled(0.5).reason, "");
  EXPECT_TRUE(says(pooled(0.3).reason, {"NPE and NLE agree less about x_o", "0.3 of 0.8"}));
  EXPECT_EQ(pooled(0.01).judgment, Judgment::fails);
  EXPECT_EQ(pooled(0.01).text, "NPE and NLE CONTRADICT each other, power of NLE 0.01 of 0.8");
  plan_.study.target.recording = "recording.h5";
  EXPECT_TRUE(says(pooled(0.01).reason,
                   {"NPE and NLE", "like none of the simulations", "observation_noise.scale"}));
  data_.runs.front().notes.pool = PoolNotes{{1.0, 0.0}, {1.0, 0.0}, 0.0};
  EXPECT_EQ(verdict_of(Check::sampling).text, "passes") << "held-out simulations have left NLE out";
}

TEST_F(Verdicts, ARefinementWhoseCertificateFailsFails) {
  plan_.study.methods.front().algorithm.kind = inference::Algorithm::refine;
  const inference::ImportanceCertificate good{.power = 1.0,
                                              .wanted_power = 1.0,
                                              .ess = 1200.0,
                                              .wanted_ess = 1000.0,
                                              .efficiency = 0.1,
                                              .pareto_k = 0.5};
  data_.runs.front().notes.certificate = good;
  EXPECT_EQ(verdict_of(Check::sampling).text, "passes, effective size 1200, Pareto k 0.5");
  EXPECT_EQ(verdict_of(Check::sampling).reason, "");
  inference::ImportanceCertificate& own = *data_.runs.front().notes.certificate;
  own.power = own.wanted_power = 0.003;
  EXPECT_EQ(verdict_of(Check::sampling).text,
            "passes, effective size 1200, Pareto k 0.5, power 0.003");
  EXPECT_TRUE(says(verdict_of(Check::sampling).reason,
                   {"it believes the recording to a power of 0.003: simulator or noise are far"}));
  own = good;
  data_.runs.push_back(data_.runs.front());
  data_.runs.back().notes.certificate->pareto_k = 0.8;
  data_.runs.back().notes.certificate->ess = 900.0;
  const Verdict found = verdict_of(Check::sampling);
  EXPECT_EQ(found.judgment, Judgment::fails);
  EXPECT_EQ(found.text, "its draws DON'T hold in 1 of 2 seeds, effective size 900, Pareto k 0.8");
  EXPECT_TRUE(says(found.reason, {"too few effective draws, heavy weights: raise "
                                  "refine.max_simulations, or raise "
                                  "refine.level_size for heavy weights"}));
  data_.runs.back().notes.certificate->power = 0.5;
  EXPECT_TRUE(says(verdict_of(Check::sampling).reason,
                   {"power 0.5, not 1", ", or lower refine.likelihood_power"}));
  data_.target.rollouts.push_back(data_.target.rollouts.front());
  EXPECT_TRUE(says(verdict_of(Check::sampling).reason,
                   {"power 0.5, not 1", ", or let refine.cross_validate choose a smaller power"}));
  EXPECT_NE(verdict_of(Check::sampling).text.find("power 0.5 to 1"), std::string::npos);
  data_.runs.back().notes.certificate->power = 1.0;
  data_.runs.back().notes.certificate->pool_ess = 2000.0;
  EXPECT_TRUE(
      says(verdict_of(Check::sampling).reason,
           {found.reason, "; until then its samples are the points that taught its flows"}));
  std::swap(data_.runs.front(), data_.runs.back());
  EXPECT_EQ(verdict_of(Check::sampling).text, found.text) << "whatever the order of seeds";
}

TEST_F(Verdicts, APowerThatIsTheSmallestTriedIsSaid) {
  plan_.study.methods.front().algorithm.kind = inference::Algorithm::refine;
  const auto chose = [](EvaluatedRun& run, double power, double larger_or_smaller) {
    run.notes.certificate = inference::ImportanceCertificate{.power = power,
                                                             .wanted_power = power,
                                                             .ess = 1200.0,
                                                             .wanted_ess = 1000.0,
                                                             .efficiency = 0.1,
                                                             .pareto_k = 0.5};
    run.notes.powers.power = Vector::Constant(2, power);
    run.notes.powers.power(larger_or_smaller > power ? 1 : 0) = larger_or_smaller;
    run.notes.powers.crps = RowMatrix{{0.1, 0.2}, {0.2, 0.3}};
  };
  chose(data_.runs.front(), 0.003, 0.01);
  const std::string believes = "it believes the recording to a power of 0.003";
  EXPECT_TRUE(says(verdict_of(Check::sampling).reason, {believes + ", the smallest that was"}));
  data_.runs.push_back(data_.runs.front());
  chose(data_.runs.front(), 0.003, 0.001);
  chose(data_.runs.back(), 0.01, 0.03);
  EXPECT_TRUE(says(verdict_of(Check::sampling).reason, {believes + ": simulator or noise"}))
      << "the seed whose power is least has tried a smaller one";
}

TEST_F(Verdicts, ASmallPowerThatLargerOnesAreAsGoodAsBlamesNoSimulator) {
  plan_.study.methods.front().algorithm.kind = inference::Algorithm::refine;
  PosteriorNotes& notes = data_.runs.front().notes;
  notes.certificate = inference::ImportanceCertificate{
      .power = 0.01, .wanted_power = 0.01, .ess = 1200.0, .wanted_ess = 1000.0, .pareto_k = 0.5};
  notes.powers.power = Vector{{0.01, 0.1, 1.0}};
  notes.powers.crps = RowMatrix{{0.11, 0.15}, {0.1, 0.14}, {0.2, 0.3}};
  EXPECT_TRUE(says(verdict_of(Check::sampling).reason,
                   {"powers from 0.01 to 0.1 predict rollouts that are left out about as well"}));
  notes.powers.crps.row(1) *= 2.0;
  EXPECT_TRUE(says(verdict_of(Check::sampling).reason, {"it believes the recording to a power"}));
}

TEST_F(Verdicts, ARefinementThatMissesTheModeOfAnotherSeedFails) {
  plan_.study.methods.front().algorithm.kind = inference::Algorithm::refine;
  data_.runs.front().notes.certificate = inference::ImportanceCertificate{
      .power = 1.0, .wanted_power = 1.0, .ess = 1200.0, .wanted_ess = 1000.0, .pareto_k = 0.5};
  for (const double log_evidence : {10.0, 10.3, 5.0}) {
    data_.runs.push_back(data_.runs.front());
    data_.runs.back().notes.certificate->log_evidence = log_evidence;
    data_.runs.back().notes.certificate->log_evidence_error = 0.05;
  }
  data_.runs.erase(data_.runs.begin());
  const Verdict found = verdict_of(Check::sampling);
  EXPECT_EQ(found.judgment, Judgment::fails);
  EXPECT_TRUE(found.text.starts_with("its draws DON'T hold in 1 of 3 seeds")) << found.text;
  EXPECT_TRUE(says(found.reason, {"its log Z is less than another seed's, so it has missed a "
                                  "mode: raise refine.level_size for modes"}));
  data_.runs.back().notes.certificate->power = 0.5;
  data_.runs.back().notes.certificate->wanted_power = 0.5;
  EXPECT_EQ(verdict_of(Check::sampling).judgment, Judgment::passes);
}

TEST_F(Verdicts, ASearchForThePowerThatEndedTooEarlyIsSaid) {
  plan_.study.methods.front().algorithm.kind = inference::Algorithm::refine;
  PosteriorNotes& notes = data_.runs.front().notes;
  notes.certificate = inference::ImportanceCertificate{
      .power = 0.2, .wanted_power = 0.2, .ess = 1200.0, .wanted_ess = 1000.0, .pareto_k = 0.5};
  notes.powers.power = Vector{{0.1, 0.2}};
  notes.powers.crps = RowMatrix{{0.3, 0.3}, {0.1, 0.2}};
  EXPECT_EQ(verdict_of(Check::sampling).judgment, Judgment::passes);
  EXPECT_TRUE(
      says(verdict_of(Check::sampling).reason,
           {"the largest power that was reached predicts", "raise refine.max_simulations"}));
  notes.powers.crps.row(0).swap(notes.powers.crps.row(1));
  EXPECT_EQ(verdict_of(Check::sampling).reason, "") << "smaller ones are better";
}

}  // namespace
}  // namespace npdr::pipeline
