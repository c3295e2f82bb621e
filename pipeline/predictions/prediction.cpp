#include "pipeline/predictions/prediction.h"

#include <algorithm>

#include "inference/abc/feature_distance.h"
#include "pipeline/features/simulation_features.h"

namespace npdr::pipeline {
Predictor::Predictor(const Plan& plan, Target target, const std::filesystem::path& log)
    : plan_(plan), observation_(plan.study, std::move(target)) {
  if (!plan.study.source().simulates) return;
  sim::SimulatorConfig config = plan.study.simulator;
  config.store_every = 1;
  simulator_ = plan.source->open({config, this->target(), log});
}

sim::Trajectories Predictor::simulate(const RowMatrix& complete, const StreamId& first) const {
  return simulator_ ? simulator_->simulate(complete, first) : sim::Trajectories();
}

std::map<std::string, Vector> Predictor::measure(const sim::Trajectories& trajectories) const {
  std::map<std::string, Vector> values;
  if (!simulator_) return values;
  if (!plan_.study.source().gives_motion) {
    const VectorF x_o = target().rollouts.front().states.row(1).transpose().cast<float>();
    values[name_of(Metric::distance)] =
        inference::mean_feature_distances(features_of(trajectories), scale_, x_o);
    return values;
  }
  const analysis::Metrics metrics = this->metrics();
  const analysis::TrajectoryView view = view_of(trajectories);
  const auto measured = [&](Metric metric) -> Vector {
    switch (metric) {
      case Metric::dtw:
        return metrics.dtw(view);
      case Metric::rmse:
        return metrics.rmse(view);
      case Metric::final_error:
        return metrics.final_error(view);
      case Metric::goal:
        return metrics.goal(view, *plan_.source->info().goal);
      case Metric::distance:
        break;  // of features
    }
    return {};
  };
  for (const Metric metric : plan_.study.evaluate.metrics) {
    values[name_of(metric)] = measured(metric);
  }
  return values;
}

Judge::Judge(const Plan& plan, const Node& node)
    : seen_(plan, read_target(plan, node), log_of(node.path)) {
  if (plan.study.source().predicts_features()) {
    const Node& of_prior = plan.input(node, "prior_predictive");
    seen_.set_scale_of_features(scale_of_features(of_prior, plan.study.tails()));
  }
  if (std::optional<Target> held_out = read_held_out(plan, node)) {
    const std::filesystem::path log = log_of(node.path);
    held_out_.emplace(plan, std::move(*held_out),
                      log.parent_path() / (log.stem().string() + "-held-out.log"));
  }
}

PredictedRollouts Judge::simulate(const RowMatrix& complete, const StreamId& first) const {
  PredictedRollouts predicted{seen_.simulate(complete, first), {}};
  if (held_out_) {
    predicted.held_out = held_out_->simulate(complete, within(first, "held_out_simulation"));
  }
  return predicted;
}

std::map<std::string, Vector> Judge::measure(const PredictedRollouts& predicted) const {
  std::map<std::string, Vector> values = seen_.measure(predicted.seen);
  if (!held_out_) return values;
  for (const auto& [metric, column] : held_out_->measure(predicted.held_out)) {
    values[std::string(kHeldOutPrefix) + metric] = column;
  }
  return values;
}

std::map<std::string, double> Judge::measure_one(const PredictedRollouts& predicted) const {
  std::map<std::string, double> values;
  for (const auto& [metric, column] : measure(predicted)) values[metric] = column(0);
  return values;
}

analysis::TrajectoryView view_of(const sim::Trajectories& t) {
  return {t.values, t.num_rows, t.num_rollouts, t.num_steps, t.num_states};
}

SearchBox search_box(const std::vector<inference::Marginal>& prior,
                     const sim::SimulatorInfo& info) {
  const auto dimension = static_cast<Index>(prior.size());
  SearchBox box{Vector(dimension), Vector(dimension)};
  for (Index d = 0; d < dimension; ++d) {
    const inference::Marginal& m = prior[static_cast<std::size_t>(d)];
    const sim::Parameter& parameter =
        info.parameters[static_cast<std::size_t>(sim::parameter_index(info, m.name))];
    const auto [lower, upper] = m.central_range(4.0);
    box.lower(d) = std::max(lower, parameter.lower);
    box.upper(d) = std::min(upper, parameter.upper);
  }
  return box;
}

}  // namespace npdr::pipeline
