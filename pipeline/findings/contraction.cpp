// Contraction of each parameter, and contradictions between posteriors.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/summary.h"
#include "core/normal.h"
#include "inference/diagnostics/share_of_prior.h"
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

// Samples (n) of parameter d in coordinates of which the prior is standard normal.
Vector normal_samples(const MethodResults& m, const EvaluatedRun& run, Index d) {
  return inference::Prior({m.data.marginal(d)}).to_normal(run.evaluation.theta.col(d)).col(0);
}

// By Kolmogorov-Smirnov distance, near 1 / sqrt(n) of n draws of the prior. It sees what no
// variance does: a shift, and modes, of which two may be as wide as the prior. Draws of the prior
// are as far off with a probability of 1 % at most.
bool looks_like_prior(const MethodResults& m, Index d) {
  const auto n = static_cast<double>(m.runs.front()->evaluation.theta.rows());
  const Vector distances = each(m.runs, [&](const EvaluatedRun* run) {
    const Vector u = normal_samples(m, *run, d);
    return inference::test_kolmogorov_smirnov(u.unaryExpr(&normal_cdf)).statistic;
  });
  return distances.mean() < std::max(0.1, 1.63 / std::sqrt(n));
}

// Correlations of these parameters, in coordinates of which the prior is standard normal, the mean
// over seeds (parameters, parameters); 0 of constants.
RowMatrix mean_correlations(const MethodResults& m, const std::vector<Index>& d) {
  const Index count = std::ssize(d);
  RowMatrix sum = RowMatrix::Zero(count, count);
  for (const EvaluatedRun* run : m.runs) {
    RowMatrix u(run->evaluation.theta.rows(), count);
    for (Index i = 0; i < count; ++i) {
      const Vector samples = normal_samples(m, *run, d[static_cast<std::size_t>(i)]);
      const Vector centered = samples.array() - samples.mean();
      u.col(i) = centered.stableNormalized();
    }
    sum += u.transpose() * u;
  }
  return sum / static_cast<double>(m.runs.size());
}

// The two parameters whose samples, where the prior is standard normal, correlate most, from 0.95
// on, and which are less than 0.95 contracted by themselves: the observation tells their
// combination.
Findings find_ridge(const MethodResults& m) {
  constexpr double least = 0.95;
  // Well below one, how broad the parameter is by itself matters to whoever uses it.
  constexpr double most_contracted = 0.95;
  std::vector<Index> broad = m.inferred();
  std::erase_if(broad, [&](Index d) {
    return m.data.period_of(d) > 0.0 ||
           !(contraction(m.data, m.method.name, d).mean() < most_contracted);
  });
  const CorrelatedPair ridge = most_correlated(mean_correlations(m, broad));
  if (!(std::abs(ridge.correlation) >= least)) return {};
  const auto name_of = [&](Index i) {
    return m.data.marginal(broad[static_cast<std::size_t>(i)]).name;
  };
  return {passes({.id = "ridge",
                  .what = fmt::format("only a combination of {} and {} is known",
                                      name_of(ridge.first), name_of(ridge.second)),
                  .evidence = fmt::format("correlation {:.2f} (told apart below {:.2f})",
                                          ridge.correlation, least),
                  .advice = fmt::format("Measure {} or {} and fix its value", name_of(ridge.first),
                                        name_of(ridge.second))})};
}

// That hardly any of the simulations of one round lie where a posterior of the default algorithm
// is, whose next rounds simulate there alone. None where at least 300 do, or more than a twentieth
// of the prior is, or 2^-D: posteriors of many parameters are a small part of it without being
// narrow in any.
Findings find_empty_region(const MethodResults& m) {
  constexpr double most_simulations = 300.0;
  constexpr Index rounds = 4, fewest_simulations = 100;  // of one of them
  const inference::AlgorithmConfig& algorithm = m.method.algorithm;
  const bool can_go_on = m.study.source().simulates && algorithm.num_rounds == 1 &&
                         algorithm.num_simulations >= rounds * fewest_simulations &&
                         m.is(inference::Algorithm::npe_nle);
  if (!can_go_on) return {};
  const inference::Prior prior(m.study.prior);
  const double share = each(m.runs, [&](const EvaluatedRun* run) {
                         return inference::share_of_prior(prior.to_normal(run->evaluation.theta),
                                                          {1, "region", 0, 0, 0});
                       }).mean();
  const double expected = share * static_cast<double>(algorithm.num_simulations);
  const double largest_share = std::min(0.05, std::exp2(-static_cast<double>(prior.dimension())));
  if (share > largest_share || expected > most_simulations) return {};
  return {passes({.id = "region",
                  .what = "error bars may be too wide, as few simulations lie near the posterior",
                  .evidence = fmt::format("about {:.0f} of {} simulations (good: {:.0f} or more)",
                                          expected, algorithm.num_simulations, most_simulations),
                  .advice = fmt::format(
                      "Set num_rounds = {} and num_simulations = {} (of each round) in [[method]]",
                      rounds, (algorithm.num_simulations + rounds - 1) / rounds)})};
}

double difference_of(double a, double b, double period) {
  return period > 0.0 ? std::remainder(a - b, period) : a - b;
}

// What each seed says of a parameter; periodic means are those nearest to the first.
struct SeedMoments {
  Vector means, variances;
  bool has_width = true;  ///< else samples of some seed are all the same: how sure is it?
};

SeedMoments moments_of_seeds(const MethodResults& m, Index d) {
  constexpr double rounding = 1e-9;
  const auto num_seeds = static_cast<Index>(m.runs.size());
  SeedMoments moments{Vector(num_seeds), Vector(num_seeds)};
  for (Index s = 0; s < num_seeds; ++s) {
    const auto& theta = m.runs[static_cast<std::size_t>(s)]->evaluation.theta;
    const auto found = m.data.summary_of(d, theta.col(d));
    const double first = s == 0 ? found.mean : moments.means(0);
    moments.means(s) = first + difference_of(found.mean, first, m.data.period_of(d));
    moments.variances(s) = found.std * found.std;
    moments.has_width = moments.has_width && found.std > rounding * std::abs(found.mean);
  }
  return moments;
}

// Deviation of the seeds' means of parameter d, in root mean squares of the posteriors' deviations.
// 0 of one seed, and where samples are all the same.
double spread_of_seeds(const MethodResults& m, Index d) {
  if (m.runs.size() < 2) return 0.0;
  const SeedMoments seeds = moments_of_seeds(m, d);
  if (!seeds.has_width) return 0.0;
  return analysis::summarize(seeds.means).std / std::sqrt(seeds.variances.mean());
}

// Difference of two methods' means of parameter d over all seeds, in root sums of squares of the
// deviations that a seed of each has. 0 where samples are all the same.
double distance_of_methods(const MethodResults& a, const MethodResults& b, Index d) {
  const SeedMoments mine = moments_of_seeds(a, d), other = moments_of_seeds(b, d);
  if (!mine.has_width || !other.has_width) return 0.0;
  const double difference =
      difference_of(mine.means.mean(), other.means.mean(), a.data.period_of(d));
  return std::abs(difference) / std::sqrt(mine.variances.mean() + other.variances.mean());
}

std::string distance_text(double distance, double most) {
  return fmt::format("{:.1f} times the error bars (fine up to {:.1f})", distance, most);
}

// That seeds are far apart, about which parameters: most of them are wrong, each as sure as if it
// were right.
Findings find_contradicting_seeds(const MethodResults& m) {
  constexpr double most = 0.5, far_too_much = 1.0;
  if (m.has_outer_loop()) return {};
  std::vector<std::string> parameters;
  double largest = 0.0;
  for (const Index d : m.inferred()) {
    const double found = spread_of_seeds(m, d);
    if (!(found > most)) continue;
    parameters.push_back(m.data.marginal(d).name);
    largest = std::max(largest, found);
  }
  if (parameters.empty()) return {};
  Finding said{.id = "seeds",
               .what = fmt::format("seeds disagree about {}, each as sure as if it were right",
                                   listed(parameters)),
               .evidence = "their means differ by " + distance_text(largest, most),
               .advice = "Use the samples of npdr sample, which mixes all seeds"};
  return {largest > far_too_much ? fails(std::move(said)) : passes(std::move(said))};
}

// Which other methods of the study are far from this one, each with the parameter about which it is
// farthest. Of one that takes parameters as known which the other infers, the rest may differ.
Findings find_contradicting_methods(const MethodResults& m) {
  constexpr double most = 3.0;
  const std::vector<Index> inferred = m.inferred();
  std::vector<std::string> others;
  double largest = 0.0;
  for (const std::string& name : m.data.methods) {
    const MethodResults other(m.data, name);
    if (m.has_outer_loop() || other.has_outer_loop() || inferred != other.inferred()) continue;
    const Vector distances =
        each(inferred, [&](Index d) { return distance_of_methods(m, other, d); });
    Index farthest = 0;
    const double distance = distances.maxCoeff(&farthest);
    if (!(distance > most)) continue;
    const Index d = inferred[static_cast<std::size_t>(farthest)];
    others.push_back(fmt::format("{} finds another {}", name, m.data.marginal(d).name));
    largest = std::max(largest, distance);
  }
  if (others.empty()) return {};
  const bool can_hold_out = (m.study.source().gives_motion && m.data.target.num_rollouts() > 1) ||
                            m.data.held_out || !m.data.folds.empty();
  return {passes({.id = "methods",
                  .what = fmt::format("methods disagree: {}", listed(others)),
                  .evidence = "means differ by " + distance_text(largest, most),
                  .advice = can_hold_out ? "Use the method that predicts held-out rollouts best"
                                         : advice_to_learn(m)})};
}

// A parameter that contracts by less is told from the prior by the shape of its samples alone.
constexpr double kLeastContraction = 0.1;

std::string advice_to_observe(const MethodResults& m, const std::vector<std::string>& parameters) {
  return fmt::format(
      "{} on {}",
      m.study.source().gives_motion ? "Record motion that depends" : "Add a feature that depends",
      listed(parameters));
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
Findings judge<Check::contraction>(const MethodResults& m) {
  if (m.has_too_few_samples()) return {too_few_samples(m.runs.front()->evaluation.theta.rows())};
  std::vector<std::string> unchanged;
  double largest = 0.0;
  for (const Index d : m.inferred()) {
    const double mean = contraction(m.data, m.method.name, d).mean();
    largest = std::max(largest, mean);
    if (mean < kLeastContraction && looks_like_prior(m, d)) {
      unchanged.push_back(m.data.marginal(d).name);
    }
  }
  const std::string evidence = fmt::format(
      "contraction at most {:.3g} (0: as wide as the prior, 1: known exactly)", largest);
  if (unchanged.size() == m.inferred().size()) {
    return {fails({.id = "prior",
                   .what = "nothing was learned: the posterior is the prior",
                   .evidence = evidence,
                   .advice = !m.study.source().simulates
                                 ? "Check that rows of theta and x belong together"
                             : learns(m.method) ? advice_to_learn(m)
                                                : advice_to_observe(m, unchanged)})};
  }
  Findings found = {passes({.evidence = evidence})};
  if (!unchanged.empty()) {
    found.push_back(
        passes({.id = "flat",
                .what = fmt::format("the observation says little of {}", listed(unchanged)),
                .evidence = fmt::format("contraction below {:.2g} (0: as wide as the prior)",
                                        kLeastContraction),
                .advice = advice_to_observe(m, unchanged)}));
  }
  append(found, find_ridge(m));
  append(found, find_empty_region(m));
  append(found, find_contradicting_seeds(m));
  append(found, find_contradicting_methods(m));
  return found;
}

}  // namespace npdr::pipeline
