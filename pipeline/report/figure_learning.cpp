#include <fmt/format.h>

#include <algorithm>

#include "analysis/curve_plot.h"
#include "core/text.h"
#include "pipeline/report/figure_parts.h"
#include "pipeline/report/policy_parts.h"
#include "pipeline/report/registry.h"

namespace npdr::pipeline {
namespace {

// Curves jump where a new iteration of the loop has inferred another posterior.
std::string new_beliefs(const ReportData& data) {
  std::string text;
  for (const std::string& name : drawn_methods(data.policy_methods())) {
    const MethodConfig& method = data.plan.study.method(name);
    if (method.num_iterations == 1) continue;
    text +=
        fmt::format(" {}: under {} posteriors, one after the other, for {} each.", name,
                    method.num_iterations, counted(method.policy_iterations, "search iteration"));
  }
  return text;
}

// Returns of the policy before each search iteration, those of all iterations of the loop one after
// the other, and after the last.
Vector learning_curve(const ReportData& data, const std::string& method, std::uint64_t seed) {
  Vector curve;
  for (const PolicyHistory* history : histories_of(data, method, seed)) {
    const Index kept = std::max<Index>(0, curve.size() - 1);
    curve.conservativeResize(kept + history->mean_return.size());
    curve.tail(history->mean_return.size()) = history->mean_return;
  }
  return curve;
}

analysis::Curve curve_of(const ReportData& data, const std::string& method) {
  RowMatrix experiments;
  for (const std::uint64_t seed : data.seeds) {
    const Vector curve = learning_curve(data, method, seed);
    experiments.conservativeResize(curve.size(), experiments.cols() + 1);
    experiments.rightCols(1) = curve;
  }
  const Index length = experiments.rows();
  const Vector x = Vector::LinSpaced(length, 0.0, static_cast<double>(length - 1));
  return analysis::curve_of(method, x, experiments);
}

}  // namespace

/// Learning curves of the searches for policies.
std::optional<ReportedFigure> learning_figure(const ReportData& data) {
  if (!has_policies(data)) return std::nullopt;
  analysis::CurvePlot plot{"policy_learning", "search iteration", "mean return", {}};
  for (const std::string& method : drawn_methods(data.policy_methods())) {
    plot.curves.push_back(curve_of(data, method));
  }
  return {{figure_of(plot),
           fmt::format("Return of the current policy under what its method believes, mean and "
                       "standard deviation over {}.{}",
                       data.experiments(), new_beliefs(data))}};
}

}  // namespace npdr::pipeline
