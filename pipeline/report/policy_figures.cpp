#include <fmt/format.h>

#include <algorithm>

#include "analysis/curve_plot.h"
#include "analysis/heat_map.h"
#include "core/text.h"
#include "pipeline/report/parts.h"

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

// Means over rollouts, with a standard error to either side.
analysis::Curve curve_of(const std::string& method, const PowerScores& scores) {
  const Vector mean = scores.crps.rowwise().mean();
  Vector error(mean.size());
  for (Index i = 0; i < error.size(); ++i) error(i) = scores.standard_error(i);
  return {method, scores.power.array().log10(), mean, mean - error, mean + error};
}

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

/// Scores of the powers of the likelihood that refinements chose from, of the first seed.
std::optional<ReportedFigure> power_figure(const ReportData& data) {
  std::vector<std::string> methods = data.methods;  // that chose a power
  std::erase_if(methods, [&](const std::string& method) {
    return data.runs_of(method).front()->notes.powers.power.size() == 0;
  });
  if (methods.empty()) return std::nullopt;
  analysis::CurvePlot plot{"powers", "log10 of the power", "CRPS with noise", {}};
  std::vector<std::string> taken;
  for (const std::string& method : drawn_methods(methods)) {
    const PosteriorNotes& notes = data.runs_of(method).front()->notes;
    plot.curves.push_back(curve_of(method, notes.powers));
    const double chosen = notes.certificate->wanted_power;
    taken.push_back(fmt::format("{:.3g} ({}{})", chosen, method,
                                chosen <= notes.powers.power(0) ? ", none smaller was tried" : ""));
  }
  return {
      {figure_of(plot),
       fmt::format(
           "How well the posterior without a rollout predicts that rollout, by the power of the "
           "likelihood: mean over the rollouts that inference sees, and its standard error, "
           "seed {}. Chosen was the smallest power that is about as good as any: {}.",
           data.seeds.front(), join(taken))}};
}

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
