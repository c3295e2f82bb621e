#include "pipeline/predictions/judge.h"

#include "pipeline/features/targets.h"
#include "pipeline/predictions/feature_scale.h"

namespace npdr::pipeline {

Judge::Judge(const Plan& plan, const Node& node)
    : plan_(plan), seen_(plan, read_target(plan, node), log_of(node.path)) {
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

std::map<std::string, Vector> Judge::measure(const RowMatrix& complete,
                                             const StreamId& first) const {
  if (!plan_.study.source().simulates) return {};
  return measure(seen_.simulate(complete, first), simulate_held_out(complete, first));
}

std::map<std::string, Vector> Judge::measure(const sim::Trajectories& seen,
                                             const sim::Trajectories& held_out) const {
  std::map<std::string, Vector> values = seen_.measure(seen);
  if (!held_out_) return values;
  for (const auto& [metric, column] : held_out_->measure(held_out)) {
    values[std::string(kHeldOutPrefix) + metric] = column;
  }
  return values;
}

sim::Trajectories Judge::simulate_held_out(const RowMatrix& complete, const StreamId& first) const {
  if (!held_out_) return {};
  return held_out_->simulate(complete, within(first, "held_out_simulation"));
}

std::map<std::string, double> Judge::measure_one(const Vector& complete, const StreamId& id) const {
  std::map<std::string, double> values;
  for (const auto& [metric, column] : measure(complete.transpose(), id)) values[metric] = column(0);
  return values;
}

}  // namespace npdr::pipeline
