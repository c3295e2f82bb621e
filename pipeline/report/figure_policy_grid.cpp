#include <fmt/format.h>

#include "analysis/heat_map.h"
#include "pipeline/report/figure_parts.h"
#include "pipeline/report/policy_parts.h"
#include "pipeline/report/registry.h"

namespace npdr::pipeline {
namespace {

// Mean over initial states and seeds at each point of the grid, (X, Y).
RowMatrix grid_means(const ReportData& data, const std::string& method, Searches searches,
                     Outcome outcome) {
  const PolicyGrid& grid = data.plan.study.policy.grid;
  const auto tests = tests_of(data, method, searches);
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

// `plot`: its name and scale.
std::optional<ReportedFigure> figure_of_maps(const ReportData& data, analysis::HeatMapPlot plot,
                                             Outcome outcome, const char* value) {
  const PolicyGrid& grid = data.plan.study.policy.grid;
  const std::vector<std::string> methods = data.policy_methods();
  if (methods.empty() || !grid.is_used()) return std::nullopt;
  plot.x = axis_of(data, grid.x);
  plot.y = axis_of(data, grid.y);
  plot.mark = center(data);
  plot.maps.push_back(
      {"before any search", grid_means(data, methods.front(), Searches::before, outcome)});
  for (const std::string& method : drawn_methods(methods)) {
    plot.maps.push_back({method, grid_means(data, method, Searches::after, outcome)});
  }
  return {{figure_of(plot),
           fmt::format("{} over domain parameters, mean over initial states and experiments "
                       "(seeds). Diamond: {}, which gives all other parameters.",
                       value, data.plan.study.target.truth ? "the target domain" : "nominal")}};
}

}  // namespace

/// Maps of the policies' return over the grid.
std::optional<ReportedFigure> grid_return_figure(const ReportData& data) {
  const double most = has_policies(data) ? static_cast<double>(task_info(data).num_steps) : 0.0;
  return figure_of_maps(data,
                        {.name = "policy_grid_return", .value_title = "mean return", .high = most},
                        &PolicyOutcomes::returns, "Return");
}

/// The same of their successes.
std::optional<ReportedFigure> grid_success_figure(const ReportData& data) {
  return figure_of_maps(data, {.name = "policy_grid_success", .value_title = "share of successes"},
                        &PolicyOutcomes::success, "Share of successes");
}

}  // namespace npdr::pipeline
