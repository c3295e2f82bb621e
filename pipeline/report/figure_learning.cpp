#include <fmt/format.h>

#include <algorithm>

#include "analysis/curve_plot.h"
#include "core/text.h"
#include "pipeline/report/figure_parts.h"
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
  for (const auto& run : data.policies) {  // iterations of one seed are in their order
    if (run.use.method != method || run.use.seed != seed) continue;
    const Index kept = std::max<Index>(0, curve.size() - 1);
    const Vector& returns = run.result.mean_return;
    curve.conservativeResize(kept + returns.size());
    curve.tail(returns.size()) = returns;
  }
  return curve;
}

analysis::Curve curve_of(const ReportData& data, const std::string& method) {
  std::vector<Vector> curves;
  for (const std::uint64_t seed : data.seeds) {
    curves.push_back(learning_curve(data, method, seed));
  }
  const Index length = curves.front().size();
  RowMatrix experiments(length, static_cast<Index>(curves.size()));
  for (std::size_t s = 0; s < curves.size(); ++s) {
    experiments.col(static_cast<Index>(s)) = curves[s];
  }
  const Vector x = Vector::LinSpaced(length, 0.0, static_cast<double>(length - 1));
  return analysis::curve_of(method, x, experiments);
}

analysis::ReportFigure make_learning_figure(const ReportData& data,
                                            const std::filesystem::path& folder) {
  analysis::CurvePlot plot{"policy_learning", "search iteration", "mean return", {}};
  for (const std::string& method : drawn_methods(data.policy_methods())) {
    plot.curves.push_back(curve_of(data, method));
  }
  return {
      analysis::write_curve_plot(plot, folder).svg,
      fmt::format("Return of the current policy under what its method believes, mean and "
                  "standard deviation over {}.{}{}",
                  data.experiments(), new_beliefs(data), left_out_methods(data.policy_methods()))};
}

}  // namespace

/// Learning curves of the searches for policies.
FigureEntry learning_figure() { return {Section::policies, has_policies, make_learning_figure}; }

}  // namespace npdr::pipeline
