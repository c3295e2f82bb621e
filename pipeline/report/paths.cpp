#include "pipeline/report/paths.h"

#include <algorithm>

#include "analysis/figure.h"
#include "analysis/path_plot.h"
#include "pipeline/predictions/prediction.h"

namespace npdr::pipeline {
namespace {

std::vector<RowMatrix> recorded_paths(const Target& target) {
  std::vector<RowMatrix> paths;
  for (const Rollout& rollout : target.rollouts) paths.push_back(rollout.states.leftCols(2));
  return paths;
}

analysis::PathPrediction predict(const std::string& method, const Predictor& predictor,
                                 const ParameterMap& parameters, const sim::Simulator& simulator,
                                 const RowMatrix& theta) {
  const RowMatrix complete = parameters.complete(theta);
  const sim::Trajectories trajectories = predictor.simulate(complete);
  analysis::PathPrediction prediction{method, {}, {}};
  for (Index i = 0; i < complete.rows(); ++i) {
    for (const Outline& outline : simulator.outlines(complete.row(i).transpose())) {
      if (!outline.is_fixed) prediction.outlines.push_back(outline.points);
    }
    if (trajectories.status[static_cast<std::size_t>(i)] != sim::RolloutStatus::ok) continue;
    for (Index h = 0; h < trajectories.num_rollouts; ++h) {
      prediction.paths.push_back(trajectories.rollout(i, h).leftCols(2).cast<double>());
    }
  }
  return prediction;
}

}  // namespace

std::optional<std::filesystem::path> write_path_figure(const ReportData& data, const Target& target,
                                                       const std::optional<Target>& held_out,
                                                       const std::filesystem::path& folder) {
  const Predictor predictor(data.plan, target, "");
  const auto simulator = sim::make_simulator(data.plan.study.simulator);
  analysis::PathPlot plot;
  plot.name = "paths";
  plot.unit = target.state_channels.front().unit;
  for (const Outline& outline : simulator->outlines(data.plan.source->parameters().nominal())) {
    if (outline.is_fixed) plot.fixed.push_back(outline.points);
  }
  if (plot.fixed.empty()) return std::nullopt;
  plot.recorded = recorded_paths(target);
  if (held_out) plot.held_out = recorded_paths(*held_out);
  const std::size_t drawn = std::min(data.methods.size(), analysis::kMaxMethods);
  for (std::size_t k = 0; k < drawn; ++k) {
    const RowMatrix& theta = data.runs_of(data.methods[k]).front()->evaluation.theta;
    plot.predictions.push_back(predict(data.methods[k], predictor, data.plan.source->parameters(),
                                       *simulator,
                                       theta.topRows(std::min(kDrawnSamples, theta.rows()))));
  }
  return analysis::write_path_plot(plot, folder).svg;
}

}  // namespace npdr::pipeline
