#include <fmt/format.h>

#include "analysis/heat_map.h"
#include "pipeline/report/figure_parts.h"
#include "pipeline/report/policy_parts.h"
#include "pipeline/report/registry.h"

namespace npdr::pipeline {
namespace {

// Mean over initial states and seeds at each point of the grid, (X, Y).
RowMatrix grid_means(const ReportData& data, const std::string& method, bool is_before,
                     Outcome outcome) {
  const PolicyGrid& grid = data.plan.study.policy.grid;
  const auto tests = tests_of(data, method, is_before);
  const auto num_x = static_cast<Index>(grid.x.points().size());
  const auto num_y = static_cast<Index>(grid.y.points().size());
  RowMatrix sum = RowMatrix::Zero(num_x * num_y, 1);
  for (const PolicyTest* test : tests) sum += ((*test->grid).*outcome).rowwise().mean();
  return Eigen::Map<const RowMatrix>(sum.data(), num_x, num_y) / static_cast<double>(tests.size());
}

analysis::GridAxis axis_of(const ReportData& data, const PolicyGridAxis& axis) {
  const std::vector<double> points = axis.points();
  const auto p = static_cast<std::size_t>(sim::parameter_index(data.info, axis.parameter));
  return {axis.parameter, data.info.parameters[p].unit,
          Eigen::Map<const Vector>(points.data(), static_cast<Index>(points.size()))};
}

// Point of the target domain on the grid, or of the nominal parameters.
std::pair<double, double> center(const ReportData& data) {
  const Study& study = data.plan.study;
  const Vector theta = data.plan.source->parameters().nominal(
      study.target.truth.value_or(std::map<std::string, double>{}));
  return {theta(sim::parameter_index(data.info, study.policy.grid.x.parameter)),
          theta(sim::parameter_index(data.info, study.policy.grid.y.parameter))};
}

analysis::HeatMapPlot plot_of(const ReportData& data, Outcome outcome) {
  const PolicyGrid& grid = data.plan.study.policy.grid;
  analysis::HeatMapPlot plot;
  plot.x = axis_of(data, grid.x);
  plot.y = axis_of(data, grid.y);
  plot.mark = center(data);
  const std::vector<std::string> methods = drawn_methods(data.policy_methods());
  plot.maps.push_back({"before any search", grid_means(data, methods.front(), true, outcome)});
  for (const std::string& method : methods) {
    plot.maps.push_back({method, grid_means(data, method, false, outcome)});
  }
  return plot;
}

std::string caption_of(const ReportData& data, const char* value) {
  return fmt::format(
      "{} over domain parameters, mean over initial states and experiments (seeds). Diamond: {}, "
      "which gives all other parameters.{}",
      value, data.plan.study.target.truth ? "the target domain" : "nominal",
      left_out_methods(data.policy_methods()));
}

analysis::ReportFigure make_return(const ReportData& data, const std::filesystem::path& folder) {
  analysis::HeatMapPlot plot = plot_of(data, &PolicyOutcomes::returns);
  plot.name = "policy_grid_return";
  plot.value_title = "mean return";
  plot.high = static_cast<double>(task_info(data).num_steps);
  return {analysis::write_heat_maps(plot, folder).svg, caption_of(data, "Return")};
}

analysis::ReportFigure make_success(const ReportData& data, const std::filesystem::path& folder) {
  analysis::HeatMapPlot plot = plot_of(data, &PolicyOutcomes::success);
  plot.name = "policy_grid_success";
  plot.value_title = "share of successes";
  plot.high = 1.0;
  return {analysis::write_heat_maps(plot, folder).svg, caption_of(data, "Share of successes")};
}

bool has_grid_figures(const ReportData& data) {
  return has_policies(data) && is_tested_on_grid(data);
}

}  // namespace

/// Maps of the policies' return, and of their successes, over the grid.
FigureEntry grid_return_figure() { return {Section::policies, has_grid_figures, make_return}; }
FigureEntry grid_success_figure() { return {Section::policies, has_grid_figures, make_success}; }

}  // namespace npdr::pipeline
