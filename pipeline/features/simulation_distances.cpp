#include "pipeline/features/simulation_distances.h"

#include <cmath>

#include "analysis/metrics.h"
#include "core/constants.h"
#include "core/stop_request.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {
namespace {

constexpr Index kRowsAtOnce = 256;

// The target at the times that a simulation stores: every `stride`-th state, whole strides only.
Target thinned(const Target& target, Index stride) {
  Target result = target;
  const Index steps = target.num_steps() / stride;
  for (Rollout& rollout : result.rollouts) {
    const RowMatrix states = rollout.states, actions = rollout.actions;
    rollout.states = states(Eigen::seqN(0, steps + 1, stride), Eigen::all);
    rollout.actions = actions(Eigen::seqN(0, steps, stride), Eigen::all);
  }
  result.dt *= static_cast<double>(stride);
  return result;
}

}  // namespace

Vector metric_distances(const Plan& plan, const Node& node, const Target& target,
                        inference::AbcDistance metric) {
  const Index stride = plan.study.simulator.store_every;
  // Where a segment begins the last state of the one before counts, which is simulated: with few
  // stored states in a segment few others would be left, or none.
  const analysis::Metrics metrics(thinned(target, stride));
  const h5::File file = open_artefact(node, kSimulationSchema);
  const h5::Dataset trajectories = file.dataset("trajectories");
  const Index n = trajectories.num_rows(), steps = target.num_steps() / stride;
  trajectories.require_shape({n, target.num_rollouts(), steps, target.num_states()});
  Vector distances(n);
  std::vector<float> block;
  Progress progress(node.label() + ", distances", n);
  for (Index begin = 0; begin < n; begin += kRowsAtOnce) {
    stop_here_if_requested();
    const Index count = std::min(kRowsAtOnce, n - begin);
    block.resize(static_cast<std::size_t>(count * trajectories.row_size()));
    trajectories.read_rows<float>(begin, count, block);
    const analysis::TrajectoryView view{block, count, target.num_rollouts(), steps,
                                        target.num_states()};
    const bool is_dtw = metric == inference::AbcDistance::dtw;
    distances.segment(begin, count) = is_dtw ? metrics.dtw(view) : metrics.rmse(view);
    progress.update(begin + count);
  }
  const auto failed = [](double d) { return std::isfinite(d) ? d : kInfinity; };
  return distances.unaryExpr(failed);
}

}  // namespace npdr::pipeline
