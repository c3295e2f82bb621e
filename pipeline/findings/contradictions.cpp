// What posteriors of the same parameters say of each other.
#include <fmt/format.h>

#include <cmath>

#include "analysis/summary.h"
#include "core/text.h"
#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

// In an outer loop each seed and method has an observation of its own.
bool has_outer_loop(const MethodResults& m) { return m.study.num_iterations_of(m.method) > 1; }

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
  if (has_outer_loop(other) || m.inferred() != other.inferred()) return "";
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

}  // namespace

std::string contradiction_of_seeds(const MethodResults& m) {
  constexpr double most = 0.5;
  if (has_outer_loop(m)) return "";
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

std::string contradiction_of_methods(const MethodResults& m) {
  if (has_outer_loop(m)) return "";
  std::vector<std::string> others;
  for (const std::string& other : m.data.methods) {
    if (other != m.method.name) others.push_back(words_of_contradiction(m, {m.data, other}));
  }
  std::erase(others, "");
  if (others.empty()) return "";
  return fmt::format(
      "contradicts {} (distance of their means, in deviations): at most one of two is right, or "
      "the simulator lacks something that each makes up for in its own way; held-out rollouts "
      "tell which predicts better",
      join(others));
}

}  // namespace npdr::pipeline
