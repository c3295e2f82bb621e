#include "core/normal.h"
#include "inference/prior.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

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

Cell contraction_cell(Table& table, const ReportData& data, const std::string& method, Index d,
                      double prior_std) {
  if (!data.is_inferred(method, d)) {
    Cell cell;
    note_known(table, cell);
    return cell;
  }
  return analysis::summarize(each(data.runs_of(method), [&](const EvaluatedRun* run) {
    const auto samples = run->evaluation.theta.col(d);
    const double std = analysis::summarize_periodic(samples, data.period_of(d)).std;
    return 1.0 - std * std / (prior_std * prior_std);
  }));
}

Table make(const ReportData& data) {
  Table table = empty_table(
      "What the data tell about each parameter: 1 - posterior variance / prior variance, mean and "
      "standard deviation over seeds. 0: nothing, 1: all; below 0: the posterior is wider.",
      "Parameter", data.methods);
  Index d = 0;
  for (const inference::Marginal& marginal : data.plan.study.prior) {
    const double prior_std =
        analysis::summarize_periodic(quantiles_of(marginal), data.period_of(d)).std;
    add_row(table, marginal.name, data.methods, [&](const std::string& method) {
      return contraction_cell(table, data, method, d, prior_std);
    });
    ++d;
  }
  return table;
}

}  // namespace

/// Contraction, which says how much narrower than the prior each posterior is:
///   1 - Var(theta_d | x_o) / Var(theta_d),
/// both variances around the circular mean for a periodic parameter.
TableEntry contraction_table() { return {"contraction", Section::details, has_posteriors, make}; }

}  // namespace npdr::pipeline
