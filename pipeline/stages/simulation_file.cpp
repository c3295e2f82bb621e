#include "pipeline/stages/simulation_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/error.h"
#include "core/feature_names.h"
#include "core/text.h"
#include "pipeline/plan/schemas.h"
#include "pipeline/stages/shard_ledger.h"
#include "pipeline/stages/stage_files.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

// Trajectories hardly compress, so the fastest level is the best one.
constexpr h5::Storage kTrajectories{.chunked = true, .deflate = 1, .rows_per_chunk = 0};

const char* values_name(const Study& study) {
  return study.external.is_used() ? "x" : "trajectories";
}

h5::Shape values_shape(const Plan& plan, const Target& target, Index num_rows) {
  if (plan.study.external.is_used()) {
    return {num_rows, static_cast<Index>(plan.study.external.features.size())};
  }
  return {num_rows, target.num_rollouts(), target.num_steps() / plan.study.simulator.store_every,
          target.num_states()};
}

void describe_values(h5::Dataset& dataset, const Plan& plan, const Target& target) {
  const bool is_external = plan.study.external.is_used();
  describe_columns(
      dataset, is_external ? parse_features(plan.study.external.features) : target.state_channels);
  if (is_external) {
    dataset.label_dimensions({"row", "feature"});
    return;
  }
  dataset.set_attribute("dt", target.dt);
  dataset.set_attribute("store_every", plan.study.simulator.store_every);
  dataset.label_dimensions({"row", "rollout", "time", "channel"});
}

// "0 ok", "1 diverged", ...
std::vector<std::string> status_meanings() {
  std::vector<std::string> meanings;
  for (std::uint8_t s = 0; s <= static_cast<std::uint8_t>(sim::RolloutStatus::bad_output); ++s) {
    std::string words(sim::to_string(static_cast<sim::RolloutStatus>(s)));
    std::ranges::replace(words, '_', ' ');
    meanings.push_back(fmt::format("{} {}", s, words));
  }
  return meanings;
}

void create_row_datasets(h5::File& file, const Plan& plan, Index num_rows) {
  const auto dimension = static_cast<Index>(plan.study.prior.size());
  h5::Dataset theta = file.create_dataset("theta", h5::ElementType::f64, {num_rows, dimension});
  describe_theta(theta, plan);
  h5::Dataset status = file.create_dataset("status", h5::ElementType::u8, {num_rows});
  status.set_attribute("meaning", status_meanings());
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

// "3 crashed, 1 timed_out".
std::string failures(const h5::File& simulation) {
  std::map<std::uint8_t, Index> counts;
  for (const std::uint8_t s : simulation.dataset("status").read<std::uint8_t>()) ++counts[s];
  std::vector<std::string> parts;
  for (const auto& [status, count] : counts) {
    if (status == 0) continue;
    parts.push_back(
        fmt::format("{} {}", count, sim::to_string(static_cast<sim::RolloutStatus>(status))));
  }
  return join(parts);
}

}  // namespace

void create_simulation_datasets(h5::File& file, const Plan& plan, const Target& target,
                                Index num_rows) {
  create_row_datasets(file, plan, num_rows);
  h5::Dataset values = file.create_dataset(values_name(plan.study), h5::ElementType::f32,
                                           values_shape(plan, target, num_rows), kTrajectories);
  describe_values(values, plan, target);
}

h5::Dataset simulated_values(const h5::File& file) {
  return file.dataset(file.has("x") ? "x" : "trajectories");
}

std::vector<std::uint8_t> as_bytes(const std::vector<sim::RolloutStatus>& status) {
  std::vector<std::uint8_t> bytes;
  for (const sim::RolloutStatus s : status) bytes.push_back(static_cast<std::uint8_t>(s));
  return bytes;
}

Identity shard_identity(const Node& node, RowRange rows) {
  Identity identity = node.identity;
  identity.key_document = key_document(kSimulationShardSchema);
  identity.key_document["simulation"] = node.key;
  identity.key_document["begin"] = rows.begin;
  identity.key_document["end"] = rows.end;
  return identity;
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
  ShardLedger ledger;
  Index num_failed = 0;
  for (const RowRange rows : shards(plan, node)) {
    const std::filesystem::path path = plan.work.shard(node.key, rows.begin, rows.end);
    const h5::File shard =
        open_artefact(path, kSimulationShardSchema, shard_identity(node, rows).key());
    const Index failed = copy_rows(shard, file, rows);
    num_failed += failed;
    ledger.add(shard, rows, failed);
    writer.add_cost(provenance_of(shard).cost);
    sources.push_back({node.key + "/" + path.filename().string(), values_name(plan.study),
                       rows.end - rows.begin});
  }
  h5::Dataset values = file.create_virtual_dataset(values_name(plan.study), h5::ElementType::f32,
                                                   values_shape(plan, target, n), sources);
  describe_values(values, plan, target);
  file.set_attribute("num_failed", num_failed);
  ledger.write(file);
  writer.finish();
}

void require_shard(const Plan& plan, const Node& node, Index number) {
  const auto count = static_cast<Index>(shards(plan, node).size());
  if (number >= 0 && number < count) return;
  throw InputError(
      fmt::format("--shard {}: {} has shards 0 to {}", number, node.label(), count - 1));
}

std::string too_many_failed(const Plan& plan, const Node& node, const h5::File& file) {
  const auto num_failed = file.attribute<Index>("num_failed");
  const Index n = num_rows(plan, node);
  const double limit = plan.study.limits.max_failed_fraction;
  if (static_cast<double>(num_failed) <= limit * static_cast<double>(n)) return "";
  const ExternalConfig& external = plan.study.external;
  const std::string advice = external.command   ? "see the logs beside its shards, narrow the prior"
                             : external.dataset ? "check the dataset and the prior"
                                                : "narrow the prior, use more simulator.substeps";
  return fmt::format(
      "{}: {} of {} rows failed{}, limits.max_failed_fraction = {} allows {}; {}, or raise the "
      "limit",
      node.path.string(), num_failed, n, external.is_used() ? " (" + failures(file) + ")" : "",
      limit, static_cast<Index>(limit * static_cast<double>(n)), advice);
}

void check_failed_rows(const Plan& plan, const Node& node) {
  const h5::File file = open_artefact(node.path, kSimulationSchema, node.key);
  const std::string failure = too_many_failed(plan, node, file);
  if (!failure.empty()) throw FailedRolloutsError(failure);
}

}  // namespace npdr::pipeline
