#include "pipeline/predictions/prediction.h"

#include "inference/abc/feature_distance.h"

namespace npdr::pipeline {
namespace {

sim::SimulatorConfig keeping_every_state(sim::SimulatorConfig config) {
  config.store_every = 1;
  return config;
}

}  // namespace

Predictor::Predictor(const Plan& plan, Target target, const std::filesystem::path& log)
    : plan_(plan), observation_(plan.study, std::move(target)) {
  if (!plan.study.source().simulates) return;
  simulator_ = plan.source->open({keeping_every_state(plan.study.simulator), this->target(), log});
}

sim::Trajectories Predictor::simulate(const RowMatrix& complete, const StreamId& first) const {
  return simulator_->simulate(complete, first);
}

std::map<std::string, Vector> Predictor::measure(const sim::Trajectories& trajectories) const {
  std::map<std::string, Vector> values;
  if (!plan_.study.source().gives_motion) {
    const VectorF x_o = target().rollouts.front().states.row(1).transpose().cast<float>();
    values[name_of(Metric::distance)] =
        inference::mean_feature_distances(features_of(trajectories), scale_, x_o);
    return values;
  }
  const analysis::Metrics metrics(target(), metrics_config());
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

Vector Predictor::rmse(const RowMatrix& theta) const {
  const sim::Trajectories trajectories = simulate(plan_.source->parameters().complete(theta));
  return analysis::Metrics(target(), metrics_config()).rmse(view_of(trajectories));
}

analysis::MetricsConfig Predictor::metrics_config() const {
  analysis::MetricsConfig config;
  config.segment_length = plan_.study.simulator.segment_length;
  return config;
}

analysis::TrajectoryView view_of(const sim::Trajectories& t) {
  return {t.values, t.num_rows, t.num_rollouts, t.num_steps, t.num_states};
}

}  // namespace npdr::pipeline
