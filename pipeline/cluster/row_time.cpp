#include "pipeline/cluster/row_time.h"

#include <chrono>
#include <filesystem>

#include "inference/prior.h"
#include "pipeline/config/simulator_info.h"
#include "pipeline/plan/schemas.h"
#include "pipeline/stages/row_simulator.h"
#include "pipeline/stages/stage_files.h"

namespace npdr::pipeline {
namespace {

// Of the first complete shard.
std::optional<double> seconds_so_far(const Plan& plan) {
  for (const Node& node : plan.nodes) {
    if (node.stage != Stage::simulate) continue;
    for (const RowRange rows : shards(plan, node)) {
      const std::filesystem::path path = plan.work.shard(node.key, rows.begin, rows.end);
      if (!std::filesystem::exists(path)) continue;
      const Cost cost = provenance_of(open_artefact(path, kSimulationShardSchema)).cost;
      return cost.core_seconds / static_cast<double>(rows.end - rows.begin);
    }
  }
  return std::nullopt;
}

// Rows of a whole batch: a simulator advances so many together.
double time_rows(const Plan& plan) {
  constexpr Index num_rows = 64;
  const sim::SimulatorInfo info = simulator_info(plan.study);
  const Target all = all_rollouts(plan);
  const Target seen = all.first(all.num_rollouts() - plan.study.target.held_out);
  const auto simulator = make_row_simulator(plan, plan.study.simulator, seen, {});
  const RowMatrix theta = inference::sample_prior(inference::Prior(plan.study.prior), num_rows, 1);
  const auto start = std::chrono::steady_clock::now();
  simulator->simulate(complete_theta(plan, info, theta), {1, "row_time", 0, 0, 0});
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  return cost_of_seconds(elapsed.count()).core_seconds / static_cast<double>(num_rows);
}

}  // namespace

std::optional<double> seconds_per_row(const Plan& plan) {
  if (const auto seconds = seconds_so_far(plan)) return seconds;
  if (plan.study.external.dataset) return 0.0;
  if (plan.study.external.command) return std::nullopt;
  return time_rows(plan);
}

}  // namespace npdr::pipeline
