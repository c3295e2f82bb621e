// How much an observation tells about each parameter.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/normal.h"
#include "core/text.h"
#include "inference/diagnostics/uniformity.h"
#include "pipeline/findings/findings.h"
#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

// Evenly spaced in probability: they stand for the prior whatever its kind.
Vector quantiles_of(const inference::Marginal& marginal) {
  constexpr Index count = 10'000;
  RowMatrix u(count, 1);
  for (Index i = 0; i < count; ++i) {
    u(i, 0) = normal_quantile((static_cast<double>(i) + 0.5) / static_cast<double>(count));
  }
  return inference::Prior({marginal}).to_theta(u).col(0);
}

double deviation(const ReportData& data, Index d, const Vector& theta) {
  const bool takes_log = data.marginal(d).is_log() && !(data.period_of(d) > 0.0);
  return data.summary_of(d, takes_log ? Vector(theta.array().log()) : theta).std;
}

// Kolmogorov-Smirnov distance from the prior: near 1 / sqrt(n) of n draws of it. It sees what no
// variance does: modes, a shift.
double distance_from_prior(const ReportData& data, const EvaluatedRun& run, Index d) {
  const inference::Prior prior({data.marginal(d)});
  const Vector u = prior.to_normal(run.evaluation.theta.col(d)).col(0);
  return inference::test_kolmogorov_smirnov(u.unaryExpr(&normal_cdf)).statistic;
}

// Two modes may be as wide as the prior. Draws of it are as far off with a probability of 1 % at
// most.
bool looks_like_prior(const MethodResults& m, Index d) {
  const auto n = static_cast<double>(m.runs.front()->evaluation.theta.rows());
  const double least = std::max(0.1, 1.63 / std::sqrt(n));
  return each(m.runs, [&](const EvaluatedRun* run) {
           return distance_from_prior(m.data, *run, d);
         }).mean() < least;
}

}  // namespace

Vector contraction(const ReportData& data, const std::string& method, Index d) {
  const double of_prior = deviation(data, d, quantiles_of(data.marginal(d)));
  return each(data.runs_of(method), [&](const EvaluatedRun* run) {
    const double std = deviation(data, d, run->evaluation.theta.col(d));
    return 1.0 - std * std / (of_prior * of_prior);
  });
}

template <>
Finding judge<Check::contraction>(const MethodResults& m) {
  constexpr double least = 0.1;
  if (m.has_too_few_samples()) return too_few_samples(m.runs.front()->evaluation.theta.rows());
  std::vector<std::string> unchanged;
  double largest = 0.0;
  const std::vector<Index> inferred = m.inferred();
  for (const Index d : inferred) {
    const double mean = contraction(m.data, m.method.name, d).mean();
    largest = std::max(largest, mean);
    if (mean < least && looks_like_prior(m, d)) unchanged.push_back(m.data.marginal(d).name);
  }
  if (unchanged.size() == inferred.size()) {
    const SourceTraits& source = m.study.source();
    return fails(
        "it IS the prior",
        fmt::format("no parameter's samples differ from the prior: the observation says nothing of "
                    "them ({} would), {}or nothing was learned ({})",
                    source.gives_motion ? "other inputs, or longer rollouts," : "other features",
                    source.simulates ? "" : "rows of theta and x don't belong together, ",
                    advice_to_learn(m.method)));
  }
  std::vector<std::string> but = {
      unchanged.empty() ? "" : fmt::format("says little of {}", join(unchanged)), words_of_ridge(m),
      words_of_region(m), contradiction_of_seeds(m), contradiction_of_methods(m)};
  std::erase(but, "");
  return passes(fmt::format("up to {:.3g}", largest), join(but, "; "));
}

}  // namespace npdr::pipeline
