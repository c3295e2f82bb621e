// Contraction of each parameter, contradictions between posteriors, and pressure of samples against
// the ends of the prior.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "analysis/summary.h"
#include "core/normal.h"
#include "core/text.h"
#include "inference/diagnostics/bound_pressure.h"
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
// combination. Empty where there are none.
std::string words_of_ridge(const MethodResults& m) {
  constexpr double least = 0.95;
  // Well below one, how broad the parameter is by itself matters to whoever uses it.
  constexpr double most_contracted = 0.95;
  std::vector<Index> broad = m.inferred();
  std::erase_if(broad, [&](Index d) {
    return m.data.period_of(d) > 0.0 ||
           !(contraction(m.data, m.method.name, d).mean() < most_contracted);
  });
  const CorrelatedPair ridge = most_correlated(mean_correlations(m, broad));
  if (!(std::abs(ridge.correlation) >= least)) return "";
  const auto name_of = [&](Index i) {
    return m.data.marginal(broad[static_cast<std::size_t>(i)]).name;
  };
  return fmt::format(
      "of {} and {} it knows little but a combination (correlation {:.2f}): measure one of them, "
      "or {} tells them apart",
      name_of(ridge.first), name_of(ridge.second), ridge.correlation,
      m.study.source().gives_motion ? "record motion that" : "add a feature that");
}

// That hardly any of the simulations of one round lie where a posterior of the default algorithm
// is, whose next rounds simulate there alone. Empty where at least 300 do, or more than a twentieth
// of the prior is, or 2^-D: posteriors of many parameters are a small part of it without being
// narrow in any.
std::string words_of_region(const MethodResults& m) {
  constexpr double most_simulations = 300.0;
  constexpr Index rounds = 4, fewest_simulations = 100;  // of one of them
  const inference::AlgorithmConfig& algorithm = m.method.algorithm;
  const bool can_go_on = m.study.source().simulates && algorithm.num_rounds == 1 &&
                         algorithm.num_simulations >= rounds * fewest_simulations &&
                         m.is(inference::Algorithm::npe_nle);
  if (!can_go_on) return "";
  const inference::Prior prior(m.study.prior);
  const double share = each(m.runs, [&](const EvaluatedRun* run) {
                         return inference::share_of_prior(prior.to_normal(run->evaluation.theta),
                                                          {1, "region", 0, 0, 0});
                       }).mean();
  const double expected = share * static_cast<double>(algorithm.num_simulations);
  const double largest_share = std::min(0.05, std::exp2(-static_cast<double>(prior.dimension())));
  if (share > largest_share || expected > most_simulations) return "";
  return fmt::format(
      "{} of {} simulations lie where it is: more of them there may make it more exact, by "
      "num_rounds = {} and num_simulations = {}, for this observation alone",
      expected < 1.0 ? "hardly any" : fmt::format("only about {:.0f}", expected),
      algorithm.num_simulations, rounds, (algorithm.num_simulations + rounds - 1) / rounds);
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

// "NPE about damping (5.1)": another method, and the parameter about which it is farthest; empty
// where that isn't far. Of one that takes parameters as known which the other infers, the rest may
// differ.
std::string words_of_contradiction(const MethodResults& m, const MethodResults& other) {
  constexpr double most = 3.0;
  if (other.has_outer_loop() || m.inferred() != other.inferred()) return "";
  double largest = most;
  std::string words;
  for (Index d = 0; d < std::ssize(m.study.prior); ++d) {
    const double distance = distance_of_methods(m, other, d);
    if (!(distance > largest)) continue;
    largest = distance;
    words =
        fmt::format("{} about {} ({:.1f})", other.method.name, m.data.marginal(d).name, distance);
  }
  return words;
}

// That seeds are far apart, about which parameters: most of them are wrong, each as sure as if it
// were right. Empty where they aren't.
std::string contradiction_of_seeds(const MethodResults& m) {
  constexpr double most = 0.5;
  if (m.has_outer_loop()) return "";
  std::vector<std::string> parameters;
  for (const Index d : m.inferred()) {
    const double found = spread_of_seeds(m, d);
    if (!(found > most)) continue;
    parameters.push_back(fmt::format("{} ({:.1f})", m.data.marginal(d).name, found));
  }
  if (parameters.empty()) return "";
  return fmt::format(
      "seeds contradict each other about {} (spread of their means, in deviations of the "
      "posteriors): believe all of them together rather than one, or try {}",
      join(parameters), advice_to_learn(m.method));
}

// Which other methods of the study are far from this one, each with the parameter about which it is
// farthest. Empty where none is.
std::string contradiction_of_methods(const MethodResults& m) {
  if (m.has_outer_loop()) return "";
  std::vector<std::string> others;
  for (const std::string& other : m.data.methods) {
    if (other != m.method.name) others.push_back(words_of_contradiction(m, {m.data, other}));
  }
  std::erase(others, "");
  if (others.empty()) return "";
  const bool can_hold_out = (m.study.source().gives_motion && m.data.target.num_rollouts() > 1) ||
                            m.data.held_out || !m.data.folds.empty();
  return fmt::format(
      "contradicts {} (distance of their means, in deviations): at most one of two is right, or "
      "the simulator lacks something that each makes up for in its own way{}",
      join(others), can_hold_out ? "; held-out rollouts tell which predicts better" : "");
}

// The atomic loss compares densities at parameters that were simulated, and sees no others.
bool may_leak(const MethodConfig& method) {
  const inference::AlgorithmConfig& algorithm = method.algorithm;
  return algorithm.kind == inference::Algorithm::npe_c && algorithm.num_rounds > 1 &&
         !algorithm.combined_loss &&
         !inference::is_analytic(algorithm, method.density_estimator.kind);
}

// Whether nothing lies beyond an end: the study says so, or the simulator's own limit is as near as
// the test tells values apart. 0 is no end of a parameter over decades, and limits of an angle are
// none: beyond lies its other end.
bool is_physical(const PressedBound& bound, const inference::Marginal& marginal,
                 const sim::Parameter& parameter) {
  using enum inference::PhysicalEnds;
  if (marginal.physical == both || marginal.physical == (bound.is_lower ? lower : upper)) {
    return true;
  }
  if (parameter.period > 0.0) return false;
  const auto place = [&](double value) { return marginal.is_log() ? std::log(value) : value; };
  const double limit = bound.is_lower ? parameter.lower : parameter.upper;
  return std::abs(place(bound.value) - place(limit)) <=
         inference::BoundPressure::kGap * (place(marginal.upper()) - place(marginal.lower()));
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

std::vector<PressedBound> pressed_bounds(const inference::Marginal& marginal,
                                         const Vector& samples) {
  if (marginal.is_unbounded()) return {};
  const Vector v = inference::Prior({marginal}).to_normal(samples).col(0).unaryExpr(&normal_cdf);
  const inference::BoundPressure found = inference::test_bounds(v);
  std::vector<PressedBound> pressed;
  if (found.presses_lower()) pressed.push_back({marginal.lower(), true, found.leaks_lower()});
  if (found.presses_upper()) pressed.push_back({marginal.upper(), false, found.leaks_upper()});
  return pressed;
}

template <>
Finding judge<Check::bounds>(const MethodResults& m) {
  if (m.has_too_few_samples()) return too_few_samples(m.runs.front()->evaluation.theta.rows());
  std::vector<std::string> pressed, physical;
  std::set<const EvaluatedRun*> failed;
  bool leaks = false;
  for (const Index d : m.inferred()) {
    const inference::Marginal& marginal = m.data.marginal(d);
    const double period = m.data.period_of(d);
    // Of an angle over all of its period both ends may hold samples.
    if (period > 0.0 && marginal.b - marginal.a >= 0.999 * period) continue;
    std::map<double, bool> bounds;  // of all seeds, and whether they are faults
    for (const EvaluatedRun* run : m.runs) {
      for (const PressedBound& bound : pressed_bounds(marginal, run->evaluation.theta.col(d))) {
        const bool has_leaked = bound.leaks && may_leak(m.method);
        const bool is_fault = has_leaked || !is_physical(bound, marginal, m.data.parameter(d));
        bounds[bound.value] |= is_fault;
        leaks |= has_leaked;
        if (is_fault) failed.insert(run);
      }
    }
    for (const auto& [bound, is_fault] : bounds) {
      const std::string unit = marginal.unit == "1" ? "" : " " + marginal.unit;
      (is_fault ? pressed : physical)
          .push_back(fmt::format("{} at {:.4g}{}", marginal.name, bound, unit));
    }
  }
  if (pressed.empty() && physical.empty()) return passes("");
  if (pressed.empty()) {
    return passes("at a physical limit",
                  fmt::format("its samples press against a physical limit, which is no fault: {}; "
                              "the truth may lie there",
                              join(physical)));
  }
  return fails(
      "PRESSES against them" + seeds_text(std::ssize(failed), m.runs.size()),
      fmt::format("its samples press against the end of the prior: {}; the prior may "
                  "exclude the truth: widen it, or look for what the simulator lacks{}",
                  join(pressed),
                  leaks ? "; or its density has leaked there: try combined_loss = true" : ""));
}

}  // namespace npdr::pipeline
