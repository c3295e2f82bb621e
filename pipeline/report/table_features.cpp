#include <fmt/format.h>

#include "analysis/feature_comparison.h"
#include "core/feature_names.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

constexpr Index kMostUnfolded = 20;  // features; a figure shows as many

struct FeatureRow {
  std::string label;
  double x_o;
  analysis::FeaturePrediction prediction;
};

std::vector<FeatureRow> feature_rows(const ReportData& data) {
  std::vector<FeatureRow> rows;
  for (Index f = 0; f < data.target.num_states(); ++f) {
    const double x_o = data.target.rollouts.front().states(1, f);
    const Channel& feature = data.target.state_channels[static_cast<std::size_t>(f)];
    for (const std::string& method : data.methods) {
      rows.push_back({fmt::format("{}, {}", feature_name(feature), method), x_o,
                      analysis::predict_feature(predicted_feature(data, method, f), x_o)});
    }
  }
  return rows;
}

}  // namespace

/// One row a feature and method: x_o, mean and standard deviation, 5, 50 and 95 % of the posterior
/// predictive distribution, and the probability of its lower tail at x_o (Gelman et al. 1996),
/// pooled over seeds.
std::optional<Table> features_table(const ReportData& data) {
  if (!predicts_features(data)) return std::nullopt;
  TableOf<FeatureRow> features{
      .caption =
          "Posterior predictive distribution of each feature, all seeds. P(x < x_o), and "
          "half of P(x = x_o): near 0 or 1 where the observation is a surprise.",
      .row_header = "Feature, method",
      .rows = feature_rows(data),
      .label = &FeatureRow::label};
  features.add("x_o", &FeatureRow::x_o);
  features.add("predicted", [](const FeatureRow& row) { return row.prediction.summary; });
  std::size_t q = 0;
  for (const char* title : {"5 %", "50 %", "95 %"}) {
    features.add(title, [q](const FeatureRow& row) { return row.prediction.quantiles[q]; });
    ++q;
  }
  features.add("P(x < x_o)", [](const FeatureRow& row) { return row.prediction.tail; });
  Table table = features.make();
  table.is_folded = data.target.num_states() > kMostUnfolded;
  return table;
}

}  // namespace npdr::pipeline
