#include "pipeline/artefacts/evaluation_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/config/study.h"

namespace npdr::pipeline {
namespace {

std::vector<std::string> metrics_of(const Layout& f) { return f.those_there(all_measured_names()); }

void describe(Layout f, PredictionScores& scores) {
  const Dim channel{"C", "channel"}, level{"L", "level"};
  f("crps", scores.crps, {channel}, "of the stored states, over the largest recorded magnitude");
  f("coverage", scores.coverage, {level, channel},
    "share of them within central bands of 10, 20, ..., 90 and 95 %");
  f("noisy_crps", scores.noisy_crps, {channel}, "the same with observation noise, if there is any",
    {.unless_empty = true});
  f("noisy_coverage", scores.noisy_coverage, {level, channel}, "the same", {.unless_empty = true});
  f("log_score", scores.log_score, {channel},
    "log of the mean density of a state, over the largest recorded magnitude [nats], if all "
    "channels have noise",
    {.unless_empty = true});
  f.attribute("share_as_seldom_within", scores.share_as_seldom_within,
              "of the samples, whose own rollouts lie within the bands of 90 % as seldom as the "
              "recorded ones");
  f.attribute("num_compared", scores.num_compared, "samples, of which that is a share");
}

void describe(Layout f, std::map<std::string, double>& log_prob) {
  std::optional<std::vector<std::string>> names;
  std::vector<double> values;
  if (!log_prob.empty()) names.emplace();
  for (const auto& [name, value] : log_prob) {
    names->push_back(name);
    values.push_back(value);
  }
  auto group = f.group("reference", names);
  if (!group) return;
  (*group)("name", *names, {{"k"}}, "the study's references, where it has any");
  (*group)("log_prob", values, {{"k"}}, "posterior density of their parameters");
  for (std::size_t i = 0; i < names->size(); ++i) log_prob[(*names)[i]] = values[i];
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

void describe(Layout f, RecordingMisfit& misfit) {
  const Dims dims = {{"HS", "part"}, {"C", "channel"}};
  f("left", misfit.left, dims,
    "root mean square errors in each tenth of each rollout, over the noise's deviation");
  f("of_noise", misfit.of_noise, dims, "the same of draws of the noise");
  f.attribute("num_rollouts", misfit.num_rollouts, "H");
  f.attribute("times", misfit.times, "the errors' size over that of draws of the noise");
  f.attribute("deviation", misfit.deviation, "of a draw's, over their mean");
  f.attribute("noise_is_given", misfit.noise_is_given,
              "1: by the study; 0: it is what neighboring samples scatter by");
  f.attribute("limit", misfit.limit, "of `times`, above which the simulator lacks something");
  f.attribute("expected", misfit.expected,
              "`times` of a right simulator, whose fit takes noise away");
  f.attribute("cause", misfit.cause, "the fault of the recording that would explain it best");
  f.attribute("change", misfit.change, "of the recording, that would mend this fault");
  f.attribute("times_of_cause", misfit.times_of_cause, "`times` with that change");
}

void describe(Layout f, PriorPredictions& prior) {
  f.each(prior.metrics, metrics_of(f), {{"S", "row"}},
         "metrics of S draws of the prior; NaN where the rollouts failed");
  describe(f, prior.scores);
}

}  // namespace

void describe(Layout f, RolloutScores& scores) {
  if (auto seen = f.group("scores", scores.seen)) describe(*seen, *scores.seen);
  if (auto rest = f.group("held_out_scores", scores.held_out)) describe(*rest, *scores.held_out);
}

void describe(Layout f, Evaluation& e) {
  const std::vector<std::string> metrics = metrics_of(f);
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

void describe(Layout f, Baseline& baseline) {
  std::vector<BaselinePoint>& points = baseline.points;
  std::vector<std::string> names;
  RowMatrix theta(std::ssize(points), std::ssize(baseline.parameters));
  std::map<std::string, Vector> metrics;
  for (const BaselinePoint& point : points) {
    const Index i = std::ssize(names);
    names.push_back(point.name);
    theta.row(i) = point.theta.transpose();
    for (const auto& [metric, value] : point.metrics) {
      metrics.try_emplace(metric, Vector(std::ssize(points))).first->second(i) = value;
    }
  }
  f("name", names, {{"n"}},
    "`nominal`; the study's references; then `truth` for a simulated target, or `floor`, the "
    "least-squares fit of a recording");
  f("theta", theta, {kRow, kParameter}, "their parameters").columns(baseline.parameters);
  f.each(metrics, metrics_of(f), {kRow},
         "their metrics, named as in an [evaluation](#evaluation); NaN where the rollouts failed");
  points.resize(std::max<std::size_t>(1, names.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    describe(f.group(fmt::format("point_{}", i + 1)), points[i].scores);
  }
  points.resize(names.size());
  if (auto group = f.group("prior", baseline.prior)) describe(*group, *baseline.prior);
  if (auto group = f.group("misfit", baseline.misfit)) describe(*group, *baseline.misfit);
  if (!f.reads()) return;
  for (Index i = 0; i < theta.rows(); ++i) {
    BaselinePoint& point = points[static_cast<std::size_t>(i)];
    point.name = names[static_cast<std::size_t>(i)];
    point.theta = theta.row(i).transpose();
    for (const auto& [metric, values] : metrics) point.metrics[metric] = values(i);
  }
}

}  // namespace npdr::pipeline
