// Parameters of which an observation tells little but a combination.
#include <fmt/format.h>

#include <cmath>

#include "pipeline/findings/findings.h"
#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

// In coordinates of which the prior is standard normal, of mean 0 and length 1.
Vector standardized(const ReportData& data, const EvaluatedRun& run, Index d) {
  const inference::Prior prior({data.marginal(d)});
  const Vector u = prior.to_normal(run.evaluation.theta.col(d)).col(0);
  const Vector centered = u.array() - u.mean();
  return centered.stableNormalized();
}

// Correlations of these parameters, the mean over seeds (parameters, parameters); 0 of constants.
RowMatrix mean_correlations(const MethodResults& m, const std::vector<Index>& d) {
  const Index count = std::ssize(d);
  RowMatrix sum = RowMatrix::Zero(count, count);
  for (const EvaluatedRun* run : m.runs) {
    RowMatrix u(run->evaluation.theta.rows(), count);
    for (Index i = 0; i < count; ++i) {
      u.col(i) = standardized(m.data, *run, d[static_cast<std::size_t>(i)]);
    }
    sum += u.transpose() * u;
  }
  return sum / static_cast<double>(m.runs.size());
}

}  // namespace

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

}  // namespace npdr::pipeline
