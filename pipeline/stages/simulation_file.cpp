#include "pipeline/stages/simulation_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "pipeline/plan/schemas.h"
#include "pipeline/stages/stage_files.h"

namespace npdr::pipeline {
namespace {

// Trajectories hardly compress, so the fastest level is the best one.
constexpr h5::Storage kTrajectories{.chunked = true, .deflate = 1, .rows_per_chunk = 0};

h5::Shape trajectory_shape(const Plan& plan, const Target& target, Index num_rows) {
  return {num_rows, target.num_rollouts(), target.num_steps() / plan.study.simulator.store_every,
          target.num_states()};
}

void describe_trajectories(h5::Dataset& dataset, const Plan& plan, const Target& target) {
  std::vector<std::string> labels, units;
  for (const Channel& channel : target.state_channels) {
    labels.push_back(channel.label);
    units.push_back(channel.unit);
  }
  dataset.set_attribute("labels", labels);
  dataset.set_attribute("units", units);
  dataset.set_attribute("dt", target.dt);
  dataset.set_attribute("store_every", plan.study.simulator.store_every);
  dataset.label_dimensions({"row", "rollout", "time", "channel"});
}

void create_row_datasets(h5::File& file, const Plan& plan, Index num_rows) {
  const auto dimension = static_cast<Index>(plan.study.prior.size());
  h5::Dataset theta = file.create_dataset("theta", h5::ElementType::f64, {num_rows, dimension});
  describe_theta(theta, plan);
  h5::Dataset status = file.create_dataset("status", h5::ElementType::u8, {num_rows});
  status.set_attribute("meaning",
                       std::vector<std::string>{"0 ok", "1 diverged", "2 out of limits"});
  status.label_dimensions({"row"});
  h5::Dataset seconds = file.create_dataset("seconds", h5::ElementType::f32, {num_rows});
  seconds.label_dimensions({"row"});
  mark_volatile(seconds);
}

// Copies the rows of a shard; returns how many failed.
Index copy_rows(const h5::File& shard, h5::File& joined, RowRange rows) {
  const Index count = rows.end - rows.begin;
  const RowMatrix theta = shard.read_matrix<double>("theta", count, -1, h5::Values::finite);
  const auto status = shard.dataset("status").read<std::uint8_t>();
  const auto seconds = shard.dataset("seconds").read<float>();
  joined.dataset("theta").write_rows<double>(
      rows.begin, count, {theta.data(), static_cast<std::size_t>(theta.size())});
  joined.dataset("status").write_rows<std::uint8_t>(rows.begin, count, status);
  joined.dataset("seconds").write_rows<float>(rows.begin, count, seconds);
  return std::count_if(status.begin(), status.end(), [](std::uint8_t s) { return s != 0; });
}

}  // namespace

void create_simulation_datasets(h5::File& file, const Plan& plan, const Target& target,
                                Index num_rows) {
  create_row_datasets(file, plan, num_rows);
  h5::Dataset trajectories =
      file.create_dataset("trajectories", h5::ElementType::f32,
                          trajectory_shape(plan, target, num_rows), kTrajectories);
  describe_trajectories(trajectories, plan, target);
}

std::vector<std::uint8_t> as_bytes(const std::vector<sim::RolloutStatus>& status) {
  std::vector<std::uint8_t> bytes;
  for (const sim::RolloutStatus s : status) bytes.push_back(static_cast<std::uint8_t>(s));
  return bytes;
}

std::vector<Index> missing_shards(const Plan& plan, const Node& node) {
  std::vector<Index> missing;
  Index number = 0;
  for (const RowRange rows : shards(plan, node)) {
    if (!std::filesystem::exists(plan.work.shard(node.key, rows.begin, rows.end))) {
      missing.push_back(number);
    }
    ++number;
  }
  return missing;
}

void join_shards(const Plan& plan, const Node& node, const Target& target) {
  const Index n = num_rows(plan, node);
  ArtefactWriter writer(node.path, kSimulationSchema, node.identity);
  h5::File& file = writer.file();
  create_row_datasets(file, plan, n);
  std::vector<h5::VirtualSource> sources;
  Index num_failed = 0;
  for (const RowRange rows : shards(plan, node)) {
    const std::filesystem::path path = plan.work.shard(node.key, rows.begin, rows.end);
    const h5::File shard = open_artefact(path, kSimulationShardSchema);
    num_failed += copy_rows(shard, file, rows);
    writer.add_wall_seconds(wall_seconds(shard));
    sources.push_back(
        {node.key + "/" + path.filename().string(), "trajectories", rows.end - rows.begin});
  }
  h5::Dataset trajectories = file.create_virtual_dataset(
      "trajectories", h5::ElementType::f32, trajectory_shape(plan, target, n), sources);
  describe_trajectories(trajectories, plan, target);
  file.set_attribute("num_failed", num_failed);
  writer.finish();
}

void check_failed_rows(const Plan& plan, const Node& node) {
  const h5::File file = open_artefact(node.path, kSimulationSchema, node.key);
  const auto num_failed = file.attribute<Index>("num_failed");
  const Index n = num_rows(plan, node);
  const double limit = plan.study.limits.max_failed_fraction;
  if (static_cast<double>(num_failed) <= limit * static_cast<double>(n)) return;
  throw FailedRolloutsError(fmt::format(
      "{}: {} of {} rows failed, limits.max_failed_fraction = {} allows {}; narrow the prior, use "
      "more simulator.substeps, or raise the limit",
      node.path.string(), num_failed, n, limit,
      static_cast<Index>(limit * static_cast<double>(n))));
}

}  // namespace npdr::pipeline
