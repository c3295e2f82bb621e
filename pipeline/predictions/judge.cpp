#include "pipeline/predictions/judge.h"

#include <algorithm>

#include "analysis/feature_comparison.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/features/targets.h"

namespace npdr::pipeline {

namespace {

// The standard deviation of each feature over the simulations of the prior.
Vector prior_deviation(const Node& simulation) {
  constexpr Index rows_at_once = 1024;
  const h5::File file = open_artefact(simulation.path, kSimulationSchema, simulation.key);
  const h5::Dataset x = simulated_values(file);
  const auto status = file.dataset("status").read<std::uint8_t>();
  analysis::FeatureSpread spread(x.row_size());
  RowMatrixF block;
  for (Index begin = 0; begin < x.num_rows(); begin += rows_at_once) {
    block.resize(std::min(rows_at_once, x.num_rows() - begin), x.row_size());
    x.read_rows<float>(begin, block.rows(), {block.data(), static_cast<std::size_t>(block.size())});
    for (Index i = 0; i < block.rows(); ++i) {
      if (status[static_cast<std::size_t>(begin + i)] != 0) continue;
      spread.add({block.row(i).data(), static_cast<std::size_t>(block.cols())});
    }
  }
  return spread.deviation();
}

}  // namespace

Judge::Judge(const Plan& plan, const Node& node)
    : plan_(plan), seen_(plan, read_target(plan, node), log_of(node.path)) {
  if (plan.study.source().predicts_features()) {
    seen_.set_feature_deviation(prior_deviation(*plan.inputs(node, Stage::simulate).front()));
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
