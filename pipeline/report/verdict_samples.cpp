// Verdicts on samples of posteriors that were evaluated: they ask for no simulation.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/quantiles.h"
#include "core/normal.h"
#include "core/text.h"
#include "inference/diagnostics/bound_pressure.h"
#include "pipeline/report/contraction.h"
#include "pipeline/report/verdicts.h"

namespace npdr::pipeline {
namespace {

using Runs = std::vector<const EvaluatedRun*>;

Verdict too_few_samples(Check check, Index count) {
  return {check, Judgment::unknown, "can't tell",
          fmt::format("{} samples are too few; raise evaluate.num_samples to {} or more", count,
                      inference::kFewestForBounds)};
}

bool has_too_few(const Runs& runs) {
  return runs.front()->evaluation.theta.rows() < inference::kFewestForBounds;
}

// The bound of parameter d that a run presses against; none where there is no such bound.
std::optional<double> pressed_bound(const ReportData& data, const EvaluatedRun& run, Index d) {
  const inference::Marginal& marginal = data.plan.study.prior[static_cast<std::size_t>(d)];
  const double period = data.period_of(d);
  const bool is_whole_period = period > 0.0 && marginal.b - marginal.a >= 0.999 * period;
  if (marginal.is_unbounded() || is_whole_period) return std::nullopt;
  const Vector v = inference::Prior({marginal})
                       .to_normal(run.evaluation.theta.col(d))
                       .col(0)
                       .unaryExpr(&normal_cdf);
  const inference::BoundPressure found = inference::test_bounds(v);
  if (found.presses_lower()) return marginal.lower();
  if (found.presses_upper()) return marginal.upper();
  return std::nullopt;
}

// The recorded states are at most 1 in its units, and 0 explains a swing with less. Where a model
// is right the floor is what noise leaves.
constexpr double kFarFloor = 0.5;

// What a posterior's RMSE is compared with: what the best of the prior reaches, or the truth, or
// the noise, below which the observation hardly tells parameters apart.
// Without noise the truth reaches zero, which no sample does: there a tenth of the prior's is small
// enough.
struct Yardstick {
  double limit = 0.0;
  double unit = 0.0;  ///< "30 times the floor's", "20 % of the prior's"
  std::string words;
};

double median_of(const Vector& values) {
  std::vector<double> finite;
  std::ranges::copy_if(values, std::back_inserter(finite),
                       [](double v) { return std::isfinite(v); });
  std::ranges::sort(finite);
  return analysis::quantile_of_sorted(finite, 0.5);
}

std::optional<Yardstick> yardstick(const ReportData& data) {
  const std::string rmse = name_of(Metric::rmse);
  const double of_prior = median_of(data.baseline.prior->metrics.at(rmse));
  Yardstick found;
  if (of_prior > 0.0) found = {0.1 * of_prior, 0.01 * of_prior, "% of the prior's"};
  for (const BaselinePoint& point : data.baseline.points) {
    if (point.name != "floor" && point.name != "truth") continue;
    const double reached = point.metrics.at(rmse);
    if (3.0 * reached > found.limit) {
      found = {3.0 * reached, reached, "times the " + point.name + "'s"};
    }
  }
  const double noise = std::min(data.plan.study.observation_noise.scale, kFarFloor);
  if (noise > found.limit) found = {noise, noise, "times the noise's scale"};
  if (found.limit > 0.0) return found;
  return std::nullopt;
}

// Samples that explain the observation no better than half of the prior's, where the rest does far
// better, belong to a mode that isn't there.
constexpr double kFarBetter = 3.0;
constexpr double kMostStrays = 0.1;

// Their share of the samples whose rollouts succeeded; 0 where the rest isn't far better, and where
// there are too few to tell.
double share_of_strays(const Vector& rmse, double of_prior) {
  const Index count = rmse.array().isFinite().count();
  if (count < inference::kFewestForBounds || !(of_prior > kFarBetter * median_of(rmse))) return 0.0;
  const Index strays = (rmse.array().isFinite() && rmse.array() > of_prior).count();
  return static_cast<double>(strays) / static_cast<double>(count);
}

// What would let a method learn more of its observation.
std::string advice_to_learn(const ReportData& data, const std::string& method) {
  using inference::EmbeddingKind;
  const MethodConfig& config = data.plan.study.method(method);
  const EmbeddingKind kind = config.embedding.kind;
  const inference::AlgorithmTraits& traits = inference::traits_of(config.algorithm.kind);
  const bool can_train = traits.family == inference::AlgorithmFamily::network &&
                         traits.role == inference::NetworkRole::posterior;
  const EmbeddingKind better = can_train ? EmbeddingKind::convolution : EmbeddingKind::all_steps;
  const bool sees_all =
      trains_layers(kind) || kind == EmbeddingKind::all_steps || kind == EmbeddingKind::identity;
  return (sees_all ? "" : fmt::format("embedding.kind = \"{}\", ", name_of(better))) +
         "more simulations";
}

Verdict unexplained(double rmse) {
  return {
      Check::fit, Judgment::fails, fmt::format("NO parameters fit, {:.2g} at best", rmse),
      fmt::format("the smallest RMSE of any parameters of the prior is {:.2g} of the largest "
                  "recorded magnitude: look at units, clock, and sign and zero of the angles of "
                  "the recording, or widen the prior",
                  rmse)};
}

// What would make predictions of rollouts that inference hasn't seen less sure of themselves.
std::string advice_to_widen(const ReportData& data, const std::string& method) {
  const MethodConfig& config = data.plan.study.method(method);
  const std::string model = "look for what simulator or noise lack (observation_noise.correlation)";
  if (config.refine.sampling.cross_validate) return model;
  const bool has_folds = data.plan.study.target.num_rollouts > 1;
  const bool is_refined = config.algorithm.kind == inference::Algorithm::refine;
  if (!has_folds) return is_refined ? "lower refine.likelihood_power, or " + model : model;
  return (is_refined ? "let refine.cross_validate choose the power of the likelihood, or "
                     : "refine it with refine.cross_validate, or ") +
         model;
}

// Of the weights of draws of the prior.
Verdict judge_weights(const Runs& runs) {
  constexpr double fewest = 100.0;
  double smallest = HUGE_VAL;
  std::size_t failed = 0;
  for (const EvaluatedRun* run : runs) {
    const double size = run->evaluation.sampler->ess.minCoeff();
    failed += size < fewest ? 1 : 0;
    smallest = std::min(smallest, size);
  }
  const std::string text = fmt::format("effective size {:.3g}", smallest);
  if (failed == 0) return {Check::sampling, Judgment::passes, "passes, " + text, ""};
  return {Check::sampling, Judgment::fails,
          "too few DIFFERENT draws" + seeds_text(failed, runs.size()) + ", " + text,
          fmt::format("its samples repeat draws of the prior, of which {:.3g} count: raise "
                      "sampler.num_candidates, or take sampler.kind = \"slice\"",
                      smallest)};
}

// What mends the faults of a refined posterior.
std::vector<std::string> remedies_of(const inference::ImportanceCertificate& certificate) {
  const bool is_heavy = has_heavy_weights(certificate);
  std::vector<std::string> remedies;
  if (std::ssize(faults_of(certificate)) > (is_heavy ? 1 : 0)) {
    remedies.emplace_back("raise refine.max_simulations");
  }
  if (certificate.power < certificate.wanted_power) {
    remedies.emplace_back("let refine.cross_validate choose a smaller power");
  }
  if (is_heavy) remedies.emplace_back("raise refine.level_size for heavy weights");
  return remedies;
}

// Whether another seed has found what this one's draws have missed. In an outer loop each seed has
// an observation of its own.
bool misses_a_mode(const ReportData& data, const EvaluatedRun& run, const Runs& runs) {
  const Study& study = data.plan.study;
  if (study.num_iterations_of(study.method(run.use.method)) > 1) return false;
  return std::ranges::any_of(runs, [&](const EvaluatedRun* other) {
    return finds_less(*run.notes.certificate, *other->notes.certificate);
  });
}

void add_new(std::vector<std::string>& all, const std::vector<std::string>& more) {
  std::ranges::copy_if(more, std::back_inserter(all), [&](const std::string& text) {
    return std::ranges::find(all, text) == all.end();
  });
}

// Of refined posteriors: the certificates of their draws.
Verdict judge_certificates(const ReportData& data, const Runs& runs) {
  std::vector<std::string> faults, remedies;
  std::size_t failed = 0;
  double smallest = HUGE_VAL, heaviest = -HUGE_VAL;
  bool has_pool = false;
  for (const EvaluatedRun* run : runs) {
    const inference::ImportanceCertificate& certificate = *run->notes.certificate;
    std::vector<std::string> its = faults_of(certificate);
    add_new(remedies, remedies_of(certificate));
    if (misses_a_mode(data, *run, runs)) {
      its.emplace_back("its log Z is less than another seed's, so it has missed a mode");
      add_new(remedies, {"raise refine.level_size for modes"});
    }
    failed += its.empty() ? 0 : 1;
    add_new(faults, its);
    smallest = std::min(smallest, certificate.ess);
    heaviest = std::max(heaviest, certificate.pareto_k);
    has_pool |= certificate.pool_ess > 0.0;
  }
  const std::string text =
      fmt::format(", effective size {:.0f}, Pareto k {:.2g}", smallest, heaviest);
  if (failed == 0) return {Check::sampling, Judgment::passes, "passes" + text, ""};
  return {Check::sampling, Judgment::fails,
          "its draws DON'T hold" + seeds_text(failed, runs.size()) + text,
          fmt::format("{}: {}{}", join(faults), join(remedies, ", or "),
                      has_pool ? "; until then its samples are the points that taught its flows, "
                                 "which independent draws don't confirm"
                               : "")};
}

}  // namespace

Verdict judge_sampling(const ReportData& data, const std::string& method) {
  const Runs runs = data.runs_of(method);
  if (runs.front()->notes.certificate) return judge_certificates(data, runs);
  if (runs.front()->evaluation.sampler->r_hat.size() == 0) return judge_weights(runs);
  double largest = 0.0;
  std::size_t failed = 0;
  for (const EvaluatedRun* run : runs) {
    const Vector& r_hat = run->evaluation.sampler->r_hat;
    if (r_hat.hasNaN()) {
      return {Check::sampling, Judgment::unknown, "can't tell",
              "fewer than four draws of each chain say nothing; raise evaluate.num_samples"};
    }
    failed += r_hat.maxCoeff() > kLargestRHat ? 1 : 0;
    largest = std::max(largest, r_hat.maxCoeff());
  }
  const std::string text = fmt::format(", R-hat {:.3f}", largest);
  if (failed == 0) return {Check::sampling, Judgment::passes, "passes" + text, ""};
  return {Check::sampling, Judgment::fails,
          std::string(traits_of(Check::sampling).failure) + seeds_text(failed, runs.size()) + text,
          "its chains are in different places: raise sampler.num_warmup; where modes lie apart, "
          "which no chain crosses, sampler.num_candidates and num_chains"};
}

Verdict judge_bounds(const ReportData& data, const std::string& method) {
  const Runs runs = data.runs_of(method);
  if (has_too_few(runs)) {
    return too_few_samples(Check::bounds, runs.front()->evaluation.theta.rows());
  }
  std::vector<std::string> pressed;
  std::size_t failed = 0;
  for (Index d = 0; d < std::ssize(data.plan.study.prior); ++d) {
    if (!data.is_inferred(method, d)) continue;
    const inference::Marginal& marginal = data.plan.study.prior[static_cast<std::size_t>(d)];
    std::size_t seeds = 0;
    double bound = 0.0;
    for (const EvaluatedRun* run : runs) {
      const std::optional<double> found = pressed_bound(data, *run, d);
      if (!found) continue;
      bound = *found;
      ++seeds;
    }
    if (seeds == 0) continue;
    failed = std::max(failed, seeds);
    pressed.push_back(fmt::format("{} at {:.4g} {}", marginal.name, bound, marginal.unit));
  }
  if (pressed.empty()) return {Check::bounds, Judgment::passes, "passes", ""};
  return {Check::bounds, Judgment::fails,
          std::string(traits_of(Check::bounds).failure) + seeds_text(failed, runs.size()),
          fmt::format("its samples press against the end of the prior: {}; the prior may exclude "
                      "the truth: widen it, or look for what the simulator lacks",
                      join(pressed))};
}

Verdict judge_contraction(const ReportData& data, const std::string& method) {
  constexpr double least = 0.1;
  const Runs runs = data.runs_of(method);
  if (has_too_few(runs)) {
    return too_few_samples(Check::contraction, runs.front()->evaluation.theta.rows());
  }
  std::vector<std::string> unchanged;
  double largest = 0.0;
  Index num_inferred = 0;
  for (Index d = 0; d < std::ssize(data.plan.study.prior); ++d) {
    if (!data.is_inferred(method, d)) continue;
    ++num_inferred;
    const double prior_std = prior_deviation(data, d);
    double mean = 0.0;
    for (const EvaluatedRun* run : runs) {
      mean += contraction(data, *run, d, prior_std) / static_cast<double>(runs.size());
    }
    largest = std::max(largest, mean);
    if (mean < least) unchanged.push_back(data.plan.study.prior[static_cast<std::size_t>(d)].name);
  }
  if (std::ssize(unchanged) == num_inferred) {
    return {Check::contraction, Judgment::fails, std::string(traits_of(Check::contraction).failure),
            "no parameter's variance is smaller than the prior's by a tenth: the observation says "
            "nothing of them (other inputs, or longer rollouts, would), or nothing was learned (" +
                advice_to_learn(data, method) + ")"};
  }
  const std::string but =
      unchanged.empty() ? "" : fmt::format("says little of {}", join(unchanged));
  return {Check::contraction, Judgment::passes, fmt::format("passes, up to {:.3g}", largest), but};
}

Verdict judge_fit(const ReportData& data, const std::string& method) {
  const std::string rmse = name_of(Metric::rmse);
  for (const BaselinePoint& point : data.baseline.points) {
    const bool is_floor = point.name == "floor";
    if (is_floor && point.metrics.at(rmse) > kFarFloor) return unexplained(point.metrics.at(rmse));
  }
  const Runs runs = data.runs_of(method);
  const std::optional<Yardstick> reached = yardstick(data);
  const double of_prior = median_of(data.baseline.prior->metrics.at(rmse));
  std::size_t failed = 0, astray = 0;
  double worst = 0.0, strays = 0.0;
  for (const EvaluatedRun* run : runs) {
    const Vector& its = run->evaluation.metrics.at(rmse);
    const double median = median_of(its);
    if (!reached || std::isnan(median)) {
      return {Check::fit, Judgment::unknown, "can't tell",
              "no rollout succeeded that an RMSE could be measured of"};
    }
    failed += median > reached->limit ? 1 : 0;
    worst = std::max(worst, median);
    const double share = share_of_strays(its, of_prior);
    astray += share > kMostStrays ? 1 : 0;
    strays = std::max(strays, share);
  }
  const double times = worst / reached->unit;
  const std::string size = times < 10.0 ? fmt::format("{:.2g} {}", times, reached->words)
                                        : fmt::format("{:.0f} {}", times, reached->words);
  if (failed == 0 && astray == 0) return {Check::fit, Judgment::passes, "passes, " + size, ""};
  if (failed == 0) {
    return {
        Check::fit, Judgment::fails,
        fmt::format("{:.0f} % of its samples are FAR off{}", 100.0 * strays,
                    seeds_text(astray, runs.size())),
        fmt::format("their RMSE is above {:.3g}, the median of the prior's; that of all of them is "
                    "{:.3g}: a mode that isn't there; try {}, or a refinement of its posterior",
                    of_prior, worst, advice_to_learn(data, method))};
  }
  return {
      Check::fit, Judgment::fails,
      std::string(traits_of(Check::fit).failure) + seeds_text(failed, runs.size()) + ", " + size,
      fmt::format("{:.3g} is the median RMSE of its samples, {}: try {}, more rounds", worst, size,
                  advice_to_learn(data, method))};
}

// A rollout that inference hasn't seen, predicted by independent draws of a posterior that is
// right, is one more draw: not one of n draws lies within the bands as seldom with a probability of
// 1 / (n + 1).
Verdict judge_held_out(const ReportData& data, const std::string& method) {
  const Runs runs = data.runs_of(method);
  const auto level = std::ranges::find(kBandLevels, kJudgedBand) - kBandLevels.begin();
  std::size_t failed = 0;
  double least = 1.0, least_failed = 1.0;
  for (const EvaluatedRun* run : runs) {
    const PredictionScores& scores = *run->evaluation.scores.held_out;
    if (scores.num_compared < inference::kFewestForBounds) {
      return too_few_samples(Check::held_out, scores.num_compared);
    }
    const bool has_noise = scores.noisy_coverage.size() > 0;
    const double covered = (has_noise ? scores.noisy_coverage : scores.coverage).row(level).mean();
    least = std::min(least, covered);
    if (scores.share_as_seldom_within > 0.0) continue;
    ++failed;
    least_failed = std::min(least_failed, covered);
  }
  const std::string text = fmt::format(", bands of {:.0f} % hold {:.0f} %", 100.0 * kJudgedBand,
                                       100.0 * (failed > 0 ? least_failed : least));
  if (failed == 0) return {Check::held_out, Judgment::passes, "passes" + text, ""};
  return {Check::held_out, Judgment::fails,
          std::string(traits_of(Check::held_out).failure) + seeds_text(failed, runs.size()) + text,
          "none of its samples' own predictions would be held so seldom, so it knows parameters or "
          "noise less well than it says: " +
              advice_to_widen(data, method)};
}

}  // namespace npdr::pipeline
