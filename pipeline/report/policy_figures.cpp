#include "pipeline/report/policy_figures.h"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/curve_plot.h"
#include "analysis/figure.h"
#include "analysis/heat_map.h"
#include "core/text.h"
#include "pipeline/predictions/closed_loop.h"

namespace npdr::pipeline {
namespace {

// The methods that figures draw: the first, as many as there are colours.
std::vector<std::string> drawn_policies(const ReportData& data) {
  std::vector<std::string> methods = data.policy_methods();
  methods.resize(std::min(methods.size(), analysis::kMaxMethods));
  return methods;
}

std::string left_out(const ReportData& data) {
  const std::size_t drawn = drawn_policies(data).size(), all = data.policy_methods().size();
  return drawn == all ? "" : fmt::format(" The first {} of {} methods.", drawn, all);
}

// Where curves jump because a new iteration of the loop has inferred another posterior.
std::string new_beliefs(const ReportData& data) {
  std::string text;
  for (const std::string& name : drawn_policies(data)) {
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
  for (const PolicyRun& run : data.policies) {  // iterations of one seed are in their order
    if (run.use.method != method || run.use.seed != seed) continue;
    const Index kept = std::max<Index>(0, curve.size() - 1);
    const Vector& returns = run.history.mean_return;
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

analysis::ReportFigure learning_figure(const ReportData& data,
                                       const std::filesystem::path& folder) {
  analysis::CurvePlot plot{"policy_learning", "search iteration", "mean return", {}};
  for (const std::string& method : drawn_policies(data)) {
    plot.curves.push_back(curve_of(data, method));
  }
  return {analysis::write_curve_plot(plot, folder).svg,
          fmt::format("Return of the current policy under what its method believes, mean and "
                      "standard deviation over {}.{}{}",
                      data.experiments(), new_beliefs(data), left_out(data))};
}

// Mean over initial states and seeds at each point of the grid, (X, Y).
RowMatrix grid_means(const ReportData& data, const std::string& method, bool is_before,
                     RowMatrix PolicyOutcomes::*outcome) {
  const PolicyGrid& grid = data.plan.study.policy.grid;
  RowMatrix sum;
  double count = 0.0;
  for (const PolicyTestRun& run : data.policy_tests) {
    if (run.use.method != method || (run.use.iteration == 0) != is_before) continue;
    const Vector means = ((*run.test.grid).*outcome).rowwise().mean();
    if (sum.size() == 0) sum = RowMatrix::Zero(means.size(), 1);
    sum += means;
    count += 1.0;
  }
  return Eigen::Map<const RowMatrix>(sum.data(), static_cast<Index>(grid.x.points().size()),
                                     static_cast<Index>(grid.y.points().size())) /
         count;
}

analysis::GridAxis axis_of(const ReportData& data, const PolicyGridAxis& axis) {
  const std::vector<double> points = axis.points();
  const auto p = static_cast<std::size_t>(sim::parameter_index(data.info, axis.parameter));
  return {axis.parameter, data.info.parameters[p].unit,
          Eigen::Map<const Vector>(points.data(), static_cast<Index>(points.size()))};
}

// Where the target domain lies on the grid, or the nominal parameters do.
std::pair<double, double> center(const ReportData& data) {
  const Study& study = data.plan.study;
  const Vector theta = data.plan.source->parameters().nominal(
      study.target.truth.value_or(std::map<std::string, double>{}));
  return {theta(sim::parameter_index(data.info, study.policy.grid.x.parameter)),
          theta(sim::parameter_index(data.info, study.policy.grid.y.parameter))};
}

std::filesystem::path write_grid_figure(const ReportData& data, const std::string& name,
                                        const std::string& value_title, double high,
                                        RowMatrix PolicyOutcomes::*outcome,
                                        const std::filesystem::path& folder) {
  const PolicyGrid& grid = data.plan.study.policy.grid;
  analysis::HeatMapPlot plot;
  plot.name = name;
  plot.x = axis_of(data, grid.x);
  plot.y = axis_of(data, grid.y);
  plot.value_title = value_title;
  plot.high = high;
  plot.mark = center(data);
  const std::vector<std::string> methods = drawn_policies(data);
  plot.maps.push_back({"before any search", grid_means(data, methods.front(), true, outcome)});
  for (const std::string& method : methods) {
    plot.maps.push_back({method, grid_means(data, method, false, outcome)});
  }
  return analysis::write_heat_maps(plot, folder).svg;
}

}  // namespace

std::vector<analysis::ReportFigure> policy_figures(const ReportData& data,
                                                   const std::filesystem::path& folder) {
  std::vector<analysis::ReportFigure> figures = {learning_figure(data, folder)};
  if (!data.plan.study.policy.grid.is_used()) return figures;
  const sim::PolicyTaskInfo info = make_task(data.plan.study)->info();
  const std::string mark = data.plan.study.target.truth ? "the target domain" : "nominal";
  const std::string caption = fmt::format(
      "over domain parameters, mean over initial states and experiments (seeds). "
      "Diamond: {}, which gives all other parameters.{}",
      mark, left_out(data));
  figures.push_back(
      {write_grid_figure(data, "policy_grid_return", "mean return",
                         static_cast<double>(info.num_steps), &PolicyOutcomes::returns, folder),
       "Return " + caption});
  figures.push_back({write_grid_figure(data, "policy_grid_success", "share of successes", 1.0,
                                       &PolicyOutcomes::success, folder),
                     "Share of successes " + caption});
  return figures;
}

}  // namespace npdr::pipeline
