#include "pipeline/stages/simulated_likelihood.h"

#include <algorithm>

#include "core/parallel.h"
#include "pipeline/features/noise.h"
#include "pipeline/features/simulation_features.h"

namespace npdr::pipeline {

SimulatedLikelihood::SimulatedLikelihood(const Plan& plan, const Node& node,
                                         const std::filesystem::path& log)
    : plan_(plan),
      target_(read_seen_target(plan, node)),
      recorded_(stored_observation(plan, target_)),
      noise_(noise_model(plan.study, target_), recorded_),
      simulator_(plan.source->open(
          {.simulator = plan.study.simulator,
           .target = target_,
           .log = log,
           .num_rows = plan.study.method(node.uses.front().method).refine.sampling.level_size})),
      id_{node.uses.front().seed, "refine_simulation", node.uses.front().stream_round(), 0, 0} {
  noise_.require_density();
}

Vector SimulatedLikelihood::of(const sim::Trajectories& rows, Index& failed) const {
  Vector result(rows.num_rows);
  parallel_for(rows.num_rows, [&](Index i) { result(i) = noise_.log_likelihood(rows.row(i)); });
  failed += std::ranges::count_if(
      rows.status, [](sim::RolloutStatus status) { return status != sim::RolloutStatus::ok; });
  return result;
}

LeftOutScore SimulatedLikelihood::left_out(const sim::Trajectories& rows, const Vector& weights,
                                           double power) const {
  return left_out_score(noise_, recorded_, rows, weights, power, within(id_, "left_out"));
}

sim::Trajectories SimulatedLikelihood::simulate(const RowMatrix& theta, Index first) const {
  StreamId id = id_;
  id.row = static_cast<std::uint64_t>(first);
  return simulator_->simulate(plan_.source->parameters().complete(theta), id);
}

}  // namespace npdr::pipeline
