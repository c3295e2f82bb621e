// Words for parameters of which an observation tells little but a combination.
#include <fmt/format.h>

#include <cmath>

#include "pipeline/report/contraction.h"
#include "pipeline/report/correlated_pair.h"
#include "pipeline/report/table_parts.h"
#include "pipeline/report/verdict_parts.h"

namespace npdr::pipeline {
namespace {

// In coordinates of which the prior is standard normal, of mean 0 and length 1.
Vector standardized(const ReportData& data, const EvaluatedRun& run, Index d) {
  const inference::Prior prior({data.plan.study.prior[static_cast<std::size_t>(d)]});
  const Vector u = prior.to_normal(run.evaluation.theta.col(d)).col(0);
  const Vector centered = u.array() - u.mean();
  return centered.stableNormalized();
}

// Correlations of these parameters, the mean over seeds (parameters, parameters); 0 of constants.
RowMatrix correlations(const ReportData& data, const Runs& runs, const std::vector<Index>& d) {
  const Index count = std::ssize(d);
  RowMatrix sum = RowMatrix::Zero(count, count);
  for (const EvaluatedRun* run : runs) {
    RowMatrix u(run->evaluation.theta.rows(), count);
    for (Index i = 0; i < count; ++i) {
      u.col(i) = standardized(data, *run, d[static_cast<std::size_t>(i)]);
    }
    sum += u.transpose() * u;
  }
  return sum / static_cast<double>(runs.size());
}

// Well below one, how broad the parameter is by itself matters to whoever uses it.
bool is_broad(const ReportData& data, const std::string& method, Index d) {
  constexpr double most = 0.95;
  if (!data.is_inferred(method, d) || data.period_of(d) > 0.0) return false;
  const double prior_std = prior_deviation(data, d);
  return each(data.runs_of(method), [&](const EvaluatedRun* run) {
           return contraction(data, *run, d, prior_std);
         }).mean() < most;
}

CorrelatedPair sharpest_ridge(const ReportData& data, const std::string& method) {
  std::vector<Index> broad;
  for (Index d = 0; d < std::ssize(data.plan.study.prior); ++d) {
    if (is_broad(data, method, d)) broad.push_back(d);
  }
  const CorrelatedPair of_broad = most_correlated(correlations(data, data.runs_of(method), broad));
  if (of_broad.correlation == 0.0) return of_broad;
  return {broad[static_cast<std::size_t>(of_broad.first)],
          broad[static_cast<std::size_t>(of_broad.second)], of_broad.correlation};
}

}  // namespace

std::string words_of_ridge(const ReportData& data, const std::string& method) {
  constexpr double least = 0.95;
  const CorrelatedPair ridge = sharpest_ridge(data, method);
  if (!(std::abs(ridge.correlation) >= least)) return "";
  return fmt::format(
      "of {} and {} it knows little but a combination (correlation {:.2f}): measure one of them, "
      "or {} tells them apart",
      name_of_parameter(data, ridge.first), name_of_parameter(data, ridge.second),
      ridge.correlation,
      data.plan.study.source().gives_motion ? "record motion that" : "add a feature that");
}

}  // namespace npdr::pipeline
