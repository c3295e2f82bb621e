#include "pipeline/report/features.h"

#include <fmt/format.h>

#include "analysis/feature_comparison.h"
#include "core/feature_names.h"

namespace npdr::pipeline {
namespace {

// Feature f of all samples of all seeds.
Vector pooled_feature(const std::vector<const EvaluatedRun*>& runs, Index f) {
  std::vector<double> values;
  for (const EvaluatedRun* run : runs) {
    for (Index i = 0; i < run->evaluation.x->rows(); ++i) {
      values.push_back(static_cast<double>((*run->evaluation.x)(i, f)));
    }
  }
  return Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
}

}  // namespace

analysis::Table features_table(const ReportData& data, const Target& target) {
  analysis::Table table;
  table.name = "features";
  table.caption =
      "Posterior predictive distribution of each feature, all seeds. P(x < x_o): near 0 or 1 where "
      "the observation is a surprise.";
  table.row_header = "Feature, method";
  table.command = data.plan.command;
  for (const char* title : {"x_o", "predicted", "5 %", "50 %", "95 %", "P(x < x_o)"}) {
    table.columns.push_back({title, false});
  }
  const RowMatrix& states = target.rollouts.front().states;
  for (Index f = 0; f < states.cols(); ++f) {
    const Channel& feature = target.state_channels[static_cast<std::size_t>(f)];
    for (const std::string& method : data.methods) {
      const analysis::FeaturePrediction prediction =
          analysis::predict_feature(pooled_feature(data.runs_of(method), f), states(1, f));
      analysis::Row row{fmt::format("{}, {}", feature_name(feature), method), {}};
      row.cells.emplace_back(states(1, f));
      row.cells.emplace_back(prediction.summary);
      for (const double quantile : prediction.quantiles) row.cells.emplace_back(quantile);
      row.cells.emplace_back(prediction.tail);
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

}  // namespace npdr::pipeline
