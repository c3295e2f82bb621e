// What posteriors of the same parameters say of each other.
#include <fmt/format.h>

#include <cmath>

#include "core/text.h"
#include "pipeline/report/table_parts.h"
#include "pipeline/report/verdict_parts.h"

namespace npdr::pipeline {
namespace {

struct Moments {
  double mean = 0.0;
  double variance = 0.0;
};

Moments moments_of(const Vector& samples) {
  const double mean = samples.mean();
  return {mean, (samples.array() - mean).square().mean()};
}

const std::string& name_of_parameter(const ReportData& data, Index d) {
  return data.plan.study.prior[static_cast<std::size_t>(d)].name;
}

// In an outer loop each seed and method has an observation of its own.
bool has_outer_loop(const ReportData& data, const std::string& method) {
  const Study& study = data.plan.study;
  return study.num_iterations_of(study.method(method)) > 1;
}

// Deviation of the seeds' means of parameter d, in root mean squares of the posteriors' deviations.
// 0 of one seed, of a periodic parameter, and where samples are all the same.
double spread_of_seeds(const ReportData& data, const Runs& runs, Index d) {
  if (runs.size() < 2 || data.period_of(d) > 0.0) return 0.0;
  const auto num_seeds = static_cast<Index>(runs.size());
  Vector means(num_seeds), variances(num_seeds);
  for (Index s = 0; s < num_seeds; ++s) {
    const Moments found = moments_of(runs[static_cast<std::size_t>(s)]->evaluation.theta.col(d));
    means(s) = found.mean;
    variances(s) = found.variance;
  }
  const double between =
      (means.array() - means.mean()).square().sum() / static_cast<double>(num_seeds - 1);
  return variances.mean() > 0.0 ? std::sqrt(between / variances.mean()) : 0.0;
}

// Difference of two methods' means of parameter d over all seeds, in deviations of their
// difference. 0 of a periodic parameter, and where all samples of one are the same.
double distance_of_methods(const ReportData& data, const std::string& a, const std::string& b,
                           Index d) {
  if (data.period_of(d) > 0.0 || !data.is_inferred(a, d) || !data.is_inferred(b, d)) return 0.0;
  const auto moments = [&](const std::string& method) {
    return moments_of(pooled(data.runs_of(method), [d](const EvaluatedRun* run) -> Vector {
      return run->evaluation.theta.col(d);
    }));
  };
  const Moments mine = moments(a), other = moments(b);
  return std::abs(mine.mean - other.mean) / std::sqrt(mine.variance + other.variance);
}

struct Contradiction {
  double distance = 0.0;
  std::string parameter;
  std::string method;
};

Contradiction farthest(const ReportData& data, const std::string& method) {
  Contradiction found;
  for (const std::string& other : data.methods) {
    if (other == method || has_outer_loop(data, other)) continue;
    for (Index d = 0; d < std::ssize(data.plan.study.prior); ++d) {
      const double distance = distance_of_methods(data, method, other, d);
      if (distance > found.distance) found = {distance, name_of_parameter(data, d), other};
    }
  }
  return found;
}

}  // namespace

std::string contradiction_of_seeds(const ReportData& data, const std::string& method) {
  constexpr double most = 0.5;
  if (has_outer_loop(data, method)) return "";
  std::vector<std::string> parameters;
  for (Index d = 0; d < std::ssize(data.plan.study.prior); ++d) {
    if (!data.is_inferred(method, d)) continue;
    const double found = spread_of_seeds(data, data.runs_of(method), d);
    if (!(found > most)) continue;
    parameters.push_back(fmt::format("{} ({:.1f})", name_of_parameter(data, d), found));
  }
  if (parameters.empty()) return "";
  return fmt::format(
      "seeds contradict each other about {} (spread of their means, in deviations of the "
      "posteriors): none is to be believed by itself; try {}",
      join(parameters), advice_to_learn(data, method));
}

std::string contradiction_of_methods(const ReportData& data, const std::string& method) {
  constexpr double most = 3.0;
  if (has_outer_loop(data, method)) return "";
  const Contradiction found = farthest(data, method);
  if (!(found.distance > most)) return "";
  return fmt::format(
      "contradicts {} about {} ({:.1f} deviations apart): at most one of them is "
      "right, or the simulator lacks something that each makes up for in its own way; compare how "
      "they predict held-out rollouts",
      found.method, found.parameter, found.distance);
}

}  // namespace npdr::pipeline
