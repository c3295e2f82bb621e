#include "pipeline/cluster/row_time.h"

#include <chrono>
#include <filesystem>

#include "inference/prior.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/features/targets.h"
#include "pipeline/plan/shards.h"

namespace npdr::pipeline {
namespace {

// Core-seconds per row of the first complete shard.
std::optional<double> seconds_so_far(const Plan& plan) {
  for (const Node& node : plan.nodes) {
    if (node.stage != Stage::simulate) continue;
    for (const Shard& shard : shards(plan, node)) {
      if (!std::filesystem::exists(shard.path)) continue;
      const Cost cost = provenance_of(open_artefact(shard.path, kSimulationShardSchema)).cost;
      return cost.core_seconds / static_cast<double>(shard.rows.size());
    }
  }
  return std::nullopt;
}

// Rows of a whole batch: a simulator advances so many together.
double time_rows(const Plan& plan) {
  constexpr Index num_rows = 64;
  const auto simulator =
      plan.source->open({.simulator = plan.study.simulator, .target = make_seen_target(plan)});
  const RowMatrix theta = inference::sample_prior(inference::Prior(plan.study.prior), num_rows, 1);
  const auto start = std::chrono::steady_clock::now();
  simulator->simulate(plan.source->parameters().complete(theta), {1, "row_time", 0, 0, 0});
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  return cost_of_seconds(elapsed.count()).core_seconds / static_cast<double>(num_rows);
}

}  // namespace

std::optional<double> seconds_per_row(const Plan& plan) {
  if (const auto seconds = seconds_so_far(plan)) return seconds;
  if (!plan.study.source().simulates) return 0.0;
  if (plan.study.source().calls_program) return std::nullopt;
  return time_rows(plan);
}

}  // namespace npdr::pipeline
