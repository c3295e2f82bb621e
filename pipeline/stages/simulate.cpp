#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <numeric>

#include "core/error.h"
#include "pipeline/plan/schemas.h"
#include "pipeline/run/progress.h"
#include "pipeline/run/stop_request.h"
#include "pipeline/stages/simulation_file.h"
#include "pipeline/stages/stage_files.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

// Rows that are simulated and written at once: bounds memory, and is a multiple of every batch.
constexpr Index kBlock = 256;

using Clock = std::chrono::steady_clock;

// The replay of one simulation: what all of its shards share.
struct Replay {
  const Plan& plan;
  const Node& node;
  const Node& proposal;
  std::unique_ptr<sim::Simulator> simulator;
  Target target;
};

Replay make_replay(const Plan& plan, const Node& node) {
  const MethodConfig& method = plan.study.method(node.uses.front().method);
  return {plan, node, *plan.inputs(node, Stage::propose).front(),
          sim::make_simulator(plan.study.simulator), read_target(plan, node, method.num_rollouts)};
}

Identity shard_identity(const Node& node, RowRange rows) {
  Identity identity = node.identity;
  identity.key_document = key_document(kSimulationShardSchema);
  identity.key_document["simulation"] = node.key;
  identity.key_document["begin"] = rows.begin;
  identity.key_document["end"] = rows.end;
  return identity;
}

void write_block(h5::File& file, const Replay& replay, RowRange rows, Index at, Index count) {
  const auto start = Clock::now();
  const RowMatrix theta =
      read_proposal(replay.proposal, {rows.begin + at, rows.begin + at + count});
  const sim::Trajectories result = replay.simulator->replay(
      replay.target, complete_theta(replay.plan, *replay.simulator, theta));
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const std::vector<float> row_seconds(static_cast<std::size_t>(count),
                                       static_cast<float>(seconds / static_cast<double>(count)));
  const std::vector<std::uint8_t> status = as_bytes(result.status);
  file.dataset("theta").write_rows<double>(at, count,
                                           {theta.data(), static_cast<std::size_t>(theta.size())});
  file.dataset("trajectories").write_rows<float>(at, count, result.values);
  file.dataset("status").write_rows<std::uint8_t>(at, count, status);
  file.dataset("seconds").write_rows<float>(at, count, row_seconds);
}

void simulate_shard(const Replay& replay, RowRange rows, Index done_before, Progress& progress) {
  const Index count = rows.end - rows.begin;
  ArtefactWriter writer(replay.plan.work.shard(replay.node.key, rows.begin, rows.end),
                        kSimulationShardSchema, shard_identity(replay.node, rows));
  create_simulation_datasets(writer.file(), replay.plan, replay.target, count);
  for (Index at = 0; at < count; at += kBlock) {
    stop_here_if_requested();
    write_block(writer.file(), replay, rows, at, std::min(kBlock, count - at));
    progress.update(done_before + std::min(at + kBlock, count));
  }
  writer.finish();
}

std::vector<Index> all_shards(std::size_t count) {
  std::vector<Index> numbers(count);
  std::iota(numbers.begin(), numbers.end(), Index{0});
  return numbers;
}

}  // namespace

void run_simulate(const Plan& plan, const Node& node, const std::vector<Index>& shard_numbers) {
  const std::vector<RowRange> ranges = shards(plan, node);
  const std::vector<Index> numbers =
      shard_numbers.empty() ? all_shards(ranges.size()) : shard_numbers;
  const Replay replay = make_replay(plan, node);
  Progress progress(node.label(), num_rows(plan, node));
  Index done = 0;
  for (const Index number : numbers) {
    if (number < 0 || number >= static_cast<Index>(ranges.size())) {
      throw InputError(fmt::format("--shard {}: {} has shards 0 to {}", number, node.label(),
                                   ranges.size() - 1));
    }
    const RowRange rows = ranges[static_cast<std::size_t>(number)];
    const bool is_there = std::filesystem::exists(plan.work.shard(node.key, rows.begin, rows.end));
    if (!is_there) simulate_shard(replay, rows, done, progress);
    done += rows.end - rows.begin;
  }
  if (missing_shards(plan, node).empty()) {
    join_shards(plan, node, replay.target);
    link_uses(plan, node);  // one can look at it also where too many rows failed
    check_failed_rows(plan, node);
  }
}

}  // namespace npdr::pipeline
