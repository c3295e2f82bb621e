#include "pipeline/stages/prediction.h"

#include <algorithm>

#include "analysis/metrics.h"
#include "pipeline/stages/stage_files.h"

namespace npdr::pipeline {
namespace {

sim::SimulatorConfig keeping_every_state(sim::SimulatorConfig config) {
  config.store_every = 1;
  return config;
}

}  // namespace

Predictor::Predictor(const Plan& plan, Target target)
    : plan_(plan),
      target_(std::move(target)),
      simulator_(sim::make_simulator(keeping_every_state(plan.study.simulator))) {}

sim::Trajectories Predictor::simulate(const RowMatrix& theta) const {
  return simulator_->replay(target_, complete_theta(plan_, *simulator_, theta));
}

std::map<std::string, Vector> Predictor::measure(const sim::Trajectories& trajectories) const {
  analysis::MetricsConfig config;
  config.segment_length = plan_.study.simulator.segment_length;
  const analysis::Metrics metrics(target_, config);
  std::map<std::string, Vector> values;
  for (const std::string& name : plan_.study.evaluate.metrics) {
    values[name] =
        name == "dtw" ? metrics.dtw(view_of(trajectories)) : metrics.rmse(view_of(trajectories));
  }
  return values;
}

Vector Predictor::rmse(const RowMatrix& theta) const {
  analysis::MetricsConfig config;
  config.segment_length = plan_.study.simulator.segment_length;
  return analysis::Metrics(target_, config).rmse(view_of(simulate(theta)));
}

Vector Predictor::nominal() const { return pick(plan_.study.simulator.parameters); }

Vector Predictor::truth() const {
  std::map<std::string, double> values = plan_.study.simulator.parameters;
  for (const auto& [name, value] : *plan_.study.target.truth) values[name] = value;
  return pick(values);
}

Vector Predictor::pick(const std::map<std::string, double>& values) const {
  const Vector all = sim::complete_theta(*simulator_, values);
  Vector picked(static_cast<Index>(plan_.study.prior.size()));
  Index d = 0;
  for (const inference::Marginal& marginal : plan_.study.prior) {
    picked(d++) = all(sim::parameter_index(simulator_->info(), marginal.name));
  }
  return picked;
}

analysis::TrajectoryView view_of(const sim::Trajectories& t) {
  return {t.values, t.num_rows, t.num_rollouts, t.num_steps, t.num_states};
}

}  // namespace npdr::pipeline
