#include "pipeline/artefacts/diagnosis_file.h"

#include <fmt/format.h>

namespace npdr::pipeline {
namespace {

constexpr const char* kPValue = "of the whole check";

template <class Test>
std::vector<double> statistics(const std::vector<Test>& tests) {
  std::vector<double> values;
  for (const Test& test : tests) values.push_back(test.statistic);
  return values;
}

void describe(Layout f, SbcResult& sbc, const std::vector<inference::Marginal>& prior) {
  const Dims dims = {kRow, kParameter};
  f("level", sbc.levels, dims, "the ranks, spread over (0, 1)", kFinite).columns(prior);
  f("rank", sbc.ranks, dims, "how many samples are smaller than the truth").columns(prior);
  if (f.reads()) {
    sbc.test = inference::test_sbc(sbc.levels);
    return;
  }
  f("kolmogorov_smirnov", statistics(sbc.test.kolmogorov_smirnov), {{"D"}},
    "a test of each parameter's levels");
  f("chi_square", statistics(sbc.test.chi_square), {{"D"}}, "another");
  f("p_value", sbc.test.parameter_p_value, {kParameter}, "of the smaller p-value of both");
  f.attribute("p_value", sbc.test.p_value, kPValue);
}

void describe(Layout f, CoverageResult& result) {
  f("level", result.levels, {kRow},
    "ranks spread over (0, 1): where the truth enters the credible region", kFinite);
  f("rank", result.ranks, {kRow}, "how many samples are more likely, or nearer, than the truth");
  inference::Coverage& coverage = result.coverage;
  if (f.reads()) {
    coverage = inference::measure_coverage(result.levels);
    return;
  }
  RowMatrix curve(coverage.level.size(), 2);
  if (curve.size() > 0) curve << coverage.level, coverage.coverage;  // Eigen's << wants a row
  f("curve", curve, {{"101"}, {"2"}}, "level, and coverage there");
  f.attribute("area", coverage.area, "mean of coverage - level above level 1/2");
  f.attribute("kolmogorov_smirnov", coverage.kolmogorov_smirnov.statistic, "of the levels");
  f.attribute("p_value", coverage.kolmogorov_smirnov.p_value, kPValue);
}

void describe(Layout f, inference::LocalC2st& test) {
  f("null", test.null, {{"200", "trial"}}, "the statistic under the hypothesis");
  f.attribute("statistic", test.statistic, "at the observation");
  f.attribute("p_value", test.p_value, kPValue);
}

void describe(Layout f, inference::Distance& distance) {
  f.attribute("observed", distance.observed, "distance of the observation");
  f.attribute("median", distance.median, "the usual one");
  f.attribute("p_value", distance.p_value, "share of simulations that are as far");
}

void describe(Layout f, inference::OutOfDistribution& ood, const char* p_value) {
  describe(f.group("mahalanobis"), ood.mahalanobis);
  describe(f.group("residual"), ood.residual);
  describe(f.group("nearest"), ood.nearest);
  f.attribute("num_components", ood.num_components, "principal components");
  f.attribute("num_reference", ood.num_reference, "simulations that say what is usual");
  f.attribute(p_value, ood.p_value, "of all features together");
}

void describe(Layout f, PredictiveResult& result) {
  const Dims dims = {{"S"}};
  f("name", result.names, dims, "what is compared, such as `rollout 1, theta: mean`");
  f("observed", result.observed, dims, "observed");
  f("median", result.median, dims, "median of the predictions; NaN: too few of them succeeded");
  f("p_value", result.check.summary_p_value, dims, "two-sided");
  f.attribute("num_failed", result.num_failed, "predictions that were left out");
  describe(f, result.check.overall, "overall_p_value");
  f.attribute("p_value", result.check.p_value, kPValue);
}

void describe(Layout f, FailureResult& result) {
  f.attribute("round", result.round,
              "whose failures depend most on the parameters; 0: none failed");
  f.attribute("num_failed", result.test.num_failed, "of its simulations");
  f.attribute("num_good", result.test.num_good, "the others of them");
  f.attribute("parameter", result.parameter, "that differs most");
  f.attribute("other", result.other,
              "whose product with it does; the same name: its square; empty: neither");
  f.attribute("shift", result.test.shift,
              "mean of the failed ones minus that of the good ones [deviations]");
  f.attribute("p_value", result.test.p_value, "of all rounds together");
}

void describe(Layout f, inference::TrainingCheck& check, Index& max_epochs) {
  f.attribute("num_epochs", check.num_epochs, "of the last round");
  f.attribute("best_epoch", check.best_epoch, "with the smallest validation loss, from 1");
  f.attribute("max_epochs", max_epochs, "that there may have been");
  f.attribute("is_converged", check.is_converged,
              "1: `stop_after_epochs` ended it, and losses don't jump about; else 0");
  f.attribute("validation_loss", check.validation_loss, "the smallest [nats]");
  f.attribute("generalisation_gap", check.generalization_gap,
              "that minus the training loss of the same epoch [nats]");
  f.attribute("recent_fall", check.recent_fall,
              "of the validation loss in the last tenth of the epochs [nats]");
}

bool are_within(const inference::CalibrationRanks& ranks) {
  const auto counts = [&](const auto& of_all) {
    return (of_all.array() >= 0).all() && (of_all.array() <= ranks.num_samples).all();
  };
  return counts(ranks.parameter) && counts(ranks.density) && counts(ranks.distance);
}

}  // namespace

std::map<std::string, double> Diagnosis::p_values() const {
  std::map<std::string, double> values;
  if (sbc) values["sbc"] = sbc->test.p_value;
  if (coverage) values["coverage"] = coverage->coverage.kolmogorov_smirnov.p_value;
  if (tarp) values["tarp"] = tarp->coverage.kolmogorov_smirnov.p_value;
  if (local_c2st) values["local_c2st"] = local_c2st->p_value;
  if (predictive) values["predictive"] = predictive->check.p_value;
  if (ood) values["ood"] = ood->p_value;
  if (failures) values["failures"] = failures->test.p_value;
  return values;
}

void describe(Layout f, Diagnosis& d) {
  f.attribute("num_samples", d.num_samples, "posterior samples per observation");
  f.attribute("num_simulations", d.num_simulations, "n of calibration, without the failed ones");
  f.attribute("num_failed", d.num_failed, "those");
  f("truth_log_prob", d.truth_log_prob, {kRow},
    "posterior density of their parameters [nats]; NaN where a normaliser would cost more",
    {.unless_empty = true});
  if (auto group = f.group("sbc", d.sbc)) describe(*group, *d.sbc, d.parameters);
  if (auto group = f.group("coverage", d.coverage)) describe(*group, *d.coverage);
  if (auto group = f.group("tarp", d.tarp)) describe(*group, *d.tarp);
  if (auto group = f.group("local_c2st", d.local_c2st)) describe(*group, *d.local_c2st);
  if (auto group = f.group("predictive", d.predictive)) describe(*group, *d.predictive);
  if (auto group = f.group("width", d.width)) {
    (*group)("excess", d.width->excess, {kParameter},
             "how many times as wide as one observation leaves it, at least");
    group->attribute("is_random", d.width->is_random,
                     "1: simulations of the same parameters differ; else 0");
  }
  if (auto group = f.group("ood", d.ood)) describe(*group, *d.ood, "p_value");
  if (auto group = f.group("failures", d.failures)) describe(*group, *d.failures);
  if (auto group = f.group("training", d.training)) describe(*group, *d.training, d.max_epochs);
}

void describe(Layout f, DiagnosisCheckpoint& checkpoint) {
  inference::CalibrationRanks& ranks = checkpoint.ranks;
  if (f.writes()) ranks.resize(ranks.num_done, ranks.theta.cols());
  f.attribute("num_samples", ranks.num_samples, "of each posterior");
  f.attribute("num_done", ranks.num_done, "simulations whose truths are ranked");
  const Dims dims = {kRow, kParameter};
  f("parameter", ranks.parameter, dims, "how many samples are smaller than the truth");
  f("density", ranks.density, {kRow}, "how many are more likely");
  f("distance", ranks.distance, {kRow}, "how many are nearer to a random draw of the prior");
  f("theta", ranks.theta, dims, "one sample of each posterior", kFinite);
  f("log_prob", ranks.log_prob, {kRow}, "density of the truths [nats]; may be NaN");
}

DiagnosisCheckpoint read_diagnosis_checkpoint(const ArtefactFile& artefact, const RowMatrix& theta,
                                              Index num_samples) {
  const auto found = kDiagnosisCheckpointSchema.read_if_there(artefact);
  if (!found) return {{.num_samples = num_samples}, {}};
  const inference::CalibrationRanks& ranks = found->ranks;
  if (ranks.num_samples == num_samples && ranks.theta.cols() == theta.cols() &&
      ranks.num_done == ranks.theta.rows() && ranks.num_done <= theta.rows() && are_within(ranks)) {
    return *found;
  }
  throw InputError(fmt::format("{}: not of this diagnosis, or damaged; remove this file",
                               artefact.path.string()));
}

}  // namespace npdr::pipeline
