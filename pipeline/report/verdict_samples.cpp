// Verdicts on where a posterior's samples lie in the prior.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/normal.h"
#include "core/text.h"
#include "inference/diagnostics/bound_pressure.h"
#include "pipeline/report/contraction.h"
#include "pipeline/report/table_parts.h"
#include "pipeline/report/verdict_parts.h"
#include "pipeline/report/verdicts.h"

namespace npdr::pipeline {
namespace {

bool has_too_few(const Runs& runs) {
  return runs.front()->evaluation.theta.rows() < inference::kFewestForBounds;
}

struct PressedBound {
  double value;
  bool leaks;  // samples lie where hardly any of the prior's do
};

// The bounds of parameter d that a run presses against; none where it has no bounds.
std::vector<PressedBound> pressed_bounds(const ReportData& data, const EvaluatedRun& run, Index d) {
  const inference::Marginal& marginal = data.plan.study.prior[static_cast<std::size_t>(d)];
  const double period = data.period_of(d);
  const bool is_whole_period = period > 0.0 && marginal.b - marginal.a >= 0.999 * period;
  if (marginal.is_unbounded() || is_whole_period) return {};
  const Vector v = inference::Prior({marginal})
                       .to_normal(run.evaluation.theta.col(d))
                       .col(0)
                       .unaryExpr(&normal_cdf);
  const inference::BoundPressure found = inference::test_bounds(v);
  std::vector<PressedBound> pressed;
  if (found.presses_lower()) pressed.push_back({marginal.lower(), found.leaks_lower()});
  if (found.presses_upper()) pressed.push_back({marginal.upper(), found.leaks_upper()});
  return pressed;
}

// Two modes may be as wide as the prior. Draws of it are as far off with a probability of 1 % at
// most.
bool looks_like_prior(const ReportData& data, const Runs& runs, Index d) {
  const auto n = static_cast<double>(runs.front()->evaluation.theta.rows());
  const double least = std::max(0.1, 1.63 / std::sqrt(n));
  return each(runs, [&](const EvaluatedRun* run) {
           return distance_from_prior(data, *run, d);
         }).mean() < least;
}

// The atomic loss compares densities at parameters that were simulated, and sees no others.
bool may_leak(const MethodConfig& method) {
  const inference::AlgorithmConfig& algorithm = method.algorithm;
  return algorithm.kind == inference::Algorithm::npe_c && algorithm.num_rounds > 1 &&
         !algorithm.combined_loss &&
         !inference::is_analytic(algorithm, method.density_estimator.kind);
}

}  // namespace

Verdict judge_bounds(const ReportData& data, const std::string& method) {
  const Runs runs = data.runs_of(method);
  if (has_too_few(runs)) {
    return too_few_samples(Check::bounds, runs.front()->evaluation.theta.rows());
  }
  std::vector<std::string> pressed;
  std::set<const EvaluatedRun*> failed;
  bool leaks = false;
  for (Index d = 0; d < std::ssize(data.plan.study.prior); ++d) {
    if (!data.is_inferred(method, d)) continue;
    const inference::Marginal& marginal = data.plan.study.prior[static_cast<std::size_t>(d)];
    std::set<double> bounds;  // of all seeds
    for (const EvaluatedRun* run : runs) {
      for (const PressedBound& bound : pressed_bounds(data, *run, d)) {
        bounds.insert(bound.value);
        leaks |= bound.leaks;
        failed.insert(run);
      }
    }
    for (const double bound : bounds) {
      const std::string unit = marginal.unit == "1" ? "" : " " + marginal.unit;
      pressed.push_back(fmt::format("{} at {:.4g}{}", marginal.name, bound, unit));
    }
  }
  if (pressed.empty()) return {Check::bounds, Judgment::passes, "passes", ""};
  return {Check::bounds, Judgment::fails,
          std::string(traits_of(Check::bounds).failure) + seeds_text(failed.size(), runs.size()),
          fmt::format("its samples press against the end of the prior: {}; the prior may exclude "
                      "the truth: widen it, or look for what the simulator lacks{}",
                      join(pressed),
                      leaks && may_leak(data.plan.study.method(method))
                          ? "; or its density has leaked there: try combined_loss = true"
                          : "")};
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
    const double mean = each(runs, [&](const EvaluatedRun* run) {
                          return contraction(data, *run, d, prior_std);
                        }).mean();
    largest = std::max(largest, mean);
    if (mean < least && looks_like_prior(data, runs, d)) {
      unchanged.push_back(data.plan.study.prior[static_cast<std::size_t>(d)].name);
    }
  }
  if (std::ssize(unchanged) == num_inferred) {
    const SourceTraits& source = data.plan.study.source();
    return {
        Check::contraction, Judgment::fails, std::string(traits_of(Check::contraction).failure),
        fmt::format("no parameter's samples differ from the prior: the observation says "
                    "nothing of them ({} would), {}or nothing was learned ({})",
                    source.gives_motion ? "other inputs, or longer rollouts," : "other features",
                    source.simulates ? "" : "rows of theta and x don't belong together, ",
                    advice_to_learn(data, method))};
  }
  std::vector<std::string> but;
  if (!unchanged.empty()) but.push_back(fmt::format("says little of {}", join(unchanged)));
  for (const std::string& words :
       {words_of_ridge(data, method), words_of_region(data, method),
        contradiction_of_seeds(data, method), contradiction_of_methods(data, method)}) {
    if (!words.empty()) but.push_back(words);
  }
  return {Check::contraction, Judgment::passes, fmt::format("passes, up to {:.3g}", largest),
          join(but, "; ")};
}

}  // namespace npdr::pipeline
