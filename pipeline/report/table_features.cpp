#include <fmt/format.h>

#include "analysis/feature_comparison.h"
#include "core/feature_names.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

constexpr Index kMostUnfolded = 20;  // features; a figure shows as many

Row feature_row(const ReportData& data, const std::string& method, Index f) {
  const auto feature_of = [f](const EvaluatedRun* run) -> Vector {
    return run->evaluation.x->col(f).cast<double>();
  };
  const double x_o = data.target.rollouts.front().states(1, f);
  const analysis::FeaturePrediction prediction =
      analysis::predict_feature(pooled(data.runs_of(method), feature_of), x_o);
  const Channel& feature = data.target.state_channels[static_cast<std::size_t>(f)];
  Row row{fmt::format("{}, {}", feature_name(feature), method), {x_o, prediction.summary}};
  for (const double quantile : prediction.quantiles) row.cells.emplace_back(quantile);
  row.cells.emplace_back(prediction.tail);
  return row;
}

Table make_features_table(const ReportData& data) {
  Table table = empty_table(
      "Posterior predictive distribution of each feature, all seeds. P(x < x_o), and half of P(x = "
      "x_o): near 0 or 1 where the observation is a surprise.",
      "Feature, method", {"x_o", "predicted", "5 %", "50 %", "95 %", "P(x < x_o)"});
  table.is_folded = data.target.num_states() > kMostUnfolded;
  for (Index f = 0; f < data.target.num_states(); ++f) {
    for (const std::string& method : data.methods) {
      table.rows.push_back(feature_row(data, method, f));
    }
  }
  return table;
}

}  // namespace

/// One row a feature and method: x_o, mean and standard deviation, 5, 50 and 95 % of the posterior
/// predictive distribution, and the probability of its lower tail at x_o (Gelman et al. 1996),
/// pooled over seeds.
TableEntry features_table() {
  return {"features", Section::fit, predicts_features, make_features_table};
}

}  // namespace npdr::pipeline
