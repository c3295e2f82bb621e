#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "analysis/feature_comparison.h"
#include "analysis/interval_plot.h"
#include "core/constants.h"
#include "core/feature_names.h"
#include "pipeline/report/parts.h"

namespace npdr::pipeline {
namespace {

// A method's samples (n) of feature f, as it was predicted, of all seeds.
Vector predicted_feature(const ReportData& data, const std::string& method, Index f) {
  return pooled(data.runs_of(method), [f](const EvaluatedRun* run) -> Vector {
    return run->evaluation.x->col(f).cast<double>();
  });
}

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

constexpr Index kMostFeatures = 20;
constexpr double kFar = 6.0;  // [standard deviations] what is farther is drawn here

// What a method predicts of each feature, relative to the observation, in units of the standard
// deviation of its predictions.
struct Surprise {
  RowMatrix quantiles;  // (F, 5)
  Vector size;          // (F) distance of the mean from the observation
};

Surprise surprise_of(const ReportData& data, const std::string& method) {
  const Index count = data.target.num_states();
  Surprise surprise{RowMatrix(count, std::ssize(analysis::kIntervalLevels)), Vector(count)};
  for (Index f = 0; f < count; ++f) {
    const Vector x = predicted_feature(data, method, f);
    const analysis::Summary summary = analysis::summarize(x);
    // Predictions are floats. One that never varies is far away, unless it is what was observed.
    const double x_o = static_cast<float>(data.target.rollouts.front().states(1, f));
    const double resolution = 1e-7 * std::max(std::abs(x_o), std::abs(summary.mean));
    const double unit = std::max({summary.std, resolution, std::numeric_limits<double>::min()});
    const auto place = [&](double value) { return std::clamp((value - x_o) / unit, -kFar, kFar); };
    surprise.size(f) = std::abs((summary.mean - x_o) / unit);
    if (!std::isfinite(surprise.size(f))) surprise.size(f) = kInfinity;  // no rollout succeeded
    surprise.quantiles.row(f) = interval_quantiles(x).unaryExpr(place);
  }
  return surprise;
}

std::string words_of(double size) {
  if (size > 1e5) return "they hardly vary, or failed";
  return fmt::format("{:.2g} standard deviations from the observation", size);
}

// Features, those that surprise any method most first.
std::vector<Index> worst_first(const std::vector<Surprise>& surprises) {
  Vector worst = surprises.front().size;
  for (const Surprise& surprise : surprises) worst = worst.cwiseMax(surprise.size);
  std::vector<Index> order(static_cast<std::size_t>(worst.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::stable_sort(order, [&](Index a, Index b) { return worst(a) > worst(b); });
  order.resize(std::min<std::size_t>(order.size(), kMostFeatures));
  return order;
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

/// Where the observed features lie among the predicted ones.
std::optional<ReportedFigure> feature_figure(const ReportData& data) {
  if (!predicts_features(data)) return std::nullopt;
  const std::vector<std::string> methods = drawn_methods(data.methods);
  std::vector<Surprise> surprises;
  for (const std::string& method : methods) surprises.push_back(surprise_of(data, method));
  const std::vector<Index> shown = worst_first(surprises);
  analysis::IntervalPlot plot;
  plot.name = "features";
  plot.title = "prediction - observation, in standard deviations";
  plot.row = {-kFar, kFar};
  for (const Index f : shown) {
    const Channel& feature = data.target.state_channels[static_cast<std::size_t>(f)];
    plot.parameters.push_back(feature_name(feature));
    plot.tips.push_back(plot.parameters.back());
  }
  for (std::size_t k = 0; k < methods.size(); ++k) {
    plot.sets.push_back({methods[k], surprises[k].quantiles(shown, Eigen::all)});
    for (std::size_t row = 0; row < shown.size(); ++row) {
      plot.tips[row] +=
          fmt::format("\n{}: {}", methods[k], words_of(surprises[k].size(shown[row])));
    }
  }
  plot.points.push_back({"observation", Vector::Zero(std::ssize(shown)),
                         analysis::LegendMark::diamond, analysis::kTruthColor});
  const Index count = data.target.num_states();
  const std::string which =
      count > kMostFeatures ? fmt::format("the {} that surprise most of {}", kMostFeatures, count)
                            : "all";
  return {{figure_of(plot),
           fmt::format("Features, {}, the greatest surprise first: median, 50 % (thick) and 90 % "
                       "interval of the posterior predictive distribution, all seeds, relative to "
                       "the observation, in standard deviations of it.",
                       which)}};
}

}  // namespace npdr::pipeline
