#include "pipeline/artefacts/evaluation_file.h"

#include "pipeline/artefacts/described_artefact.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {
namespace {

struct References {
  std::vector<std::string> names;
  std::vector<double> log_prob;
};

void describe(Layout f, std::map<std::string, double>& log_prob) {
  std::optional<References> references;
  for (const auto& [name, value] : log_prob) {
    if (!references) references.emplace();
    references->names.push_back(name);
    references->log_prob.push_back(value);
  }
  auto group = f.group("reference", references);
  if (!group) return;
  (*group)("name", references->names, {{"k"}}, "the study's references, where it has any");
  (*group)("log_prob", references->log_prob, {{"k"}}, "posterior density of their parameters");
  for (std::size_t i = 0; i < references->names.size(); ++i) {
    log_prob[references->names[i]] = references->log_prob[i];
  }
}

void describe(Layout f, inference::SamplerReport& report) {
  f("r_hat", report.r_hat, {kParameter},
    "only of posteriors that have to be sampled: split R-hat; missing for importance weights",
    {.unless_empty = true});
  f("ess", report.ess, {{"D or 1"}}, "effective sample size of the chains, or of the weights");
  f.attribute("num_evaluations", report.num_evaluations, "of the density");
}

void describe(Layout f, analysis::Bands& bands, const char* rollouts) {
  const Dims dims = {{rollouts, "rollout"}, {"T", "time"}, {"C", "channel"}};
  f("lower", bands.lower, dims, "5 % quantile of the simulated states after each step, pointwise");
  f("median", bands.median, dims, "their median; only of rollouts");
  f("upper", bands.upper, dims, "their 95 % quantile");
  f.attribute("coverage", bands.coverage, "0.9");
  f.attribute("num_samples", bands.num_samples, "those that didn't fail");
}

void describe(Layout f, InferredNoise& noise) {
  const Dims dims = {kRow, {"C", "channel"}};
  f("scale", noise.scale, dims,
    "of the observation noise of each sample's prediction, over the channel's largest recorded "
    "magnitude unless the study gives it by `std`; NaN where the rollouts failed; only where any "
    "of its parameters has a prior");
  f("correlation", noise.correlation, dims, "of neighboring stored states' noise",
    {.unless_empty = true});
  f("degrees_of_freedom", noise.degrees_of_freedom, dims, "of noise with heavy tails",
    {.unless_empty = true});
}

}  // namespace

void describe(Layout f, Evaluation& e) {
  const std::vector<std::string> metrics = f.those_there(all_measured_names());
  f("theta", e.theta, {kRow, kParameter}, "posterior samples").columns(e.parameters);
  f("log_prob", e.log_prob, {kRow}, "their posterior density [nats]");
  f.each(e.metrics, metrics, {kRow},
         "the [metrics](methods.md#evaluation) of `evaluate.metrics`; those of held-out rollouts "
         "are `held_out_rmse`, ...; NaN where the rollouts failed");
  f("nominal_log_prob", e.nominal_log_prob, {},
    "posterior density of the nominal parameters; -infinity outside of the prior; only where all "
    "parameters have a nominal value");
  f("truth_log_prob", e.truth_log_prob, {}, "that of the truth; only for a simulated target");
  describe(f, e.reference_log_prob);
  Layout map = f.group("map");
  map("theta", e.map_theta, {kParameter}, "the most likely parameters");
  map("log_prob", e.map_log_prob, {}, "their density");
  map.each(e.map_metrics, metrics, {}, "their metrics");
  if (auto sampler = f.group("sampler", e.sampler)) describe(*sampler, *e.sampler);
  if (auto bands = f.group("bands", e.bands)) describe(*bands, *e.bands, "H");
  if (auto bands = f.group("held_out_bands", e.held_out_bands)) {
    describe(*bands, *e.held_out_bands, "G");
  }
  describe(f, e.scores);
  if (auto noise = f.group("noise", e.noise)) describe(*noise, *e.noise);
  f("x", e.x, {kRow, kFeature}, "what a command gave at the samples, in place of the bands")
      .columns(e.features);
}
template struct Artefact<Evaluation>;

}  // namespace npdr::pipeline
