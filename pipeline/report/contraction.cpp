#include "pipeline/report/contraction.h"

#include "analysis/summary.h"
#include "core/normal.h"
#include "inference/diagnostics/uniformity.h"

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
  const bool takes_log =
      data.plan.study.prior[static_cast<std::size_t>(d)].is_log() && !(data.period_of(d) > 0.0);
  return data.summary_of(d, takes_log ? Vector(theta.array().log()) : theta).std;
}

}  // namespace

double prior_deviation(const ReportData& data, Index d) {
  return deviation(data, d, quantiles_of(data.plan.study.prior[static_cast<std::size_t>(d)]));
}

double contraction(const ReportData& data, const EvaluatedRun& run, Index d, double prior_std) {
  const double std = deviation(data, d, run.evaluation.theta.col(d));
  return 1.0 - std * std / (prior_std * prior_std);
}

double distance_from_prior(const ReportData& data, const EvaluatedRun& run, Index d) {
  const inference::Prior prior({data.plan.study.prior[static_cast<std::size_t>(d)]});
  const Vector u = prior.to_normal(run.evaluation.theta.col(d)).col(0);
  const Vector v = u.unaryExpr([](double z) { return normal_cdf(z); });
  return inference::test_kolmogorov_smirnov(v).statistic;
}

}  // namespace npdr::pipeline
