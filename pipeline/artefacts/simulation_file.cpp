#include "pipeline/artefacts/simulation_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/feature_names.h"
#include "core/text.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/shard_ledger.h"
#include "pipeline/artefacts/theta_columns.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

// Trajectories hardly compress, so the fastest level is the best one.
constexpr h5::Storage kTrajectories{.chunked = true, .deflate = 1, .rows_per_chunk = 0};

const char* values_name(const Study& study) {
  return study.source().gives_motion ? "trajectories" : "x";
}

h5::Shape values_shape(const Study& study, const Target& target, Index num_rows) {
  if (!study.source().gives_motion) {
    return {num_rows, static_cast<Index>(study.external.features.size())};
  }
  return {num_rows, target.num_rollouts(), target.num_steps() / study.simulator.store_every,
          target.num_states()};
}

void describe_values(h5::Dataset& dataset, const Study& study, const Target& target) {
  if (!study.source().gives_motion) {
    describe_columns(dataset, parse_features(study.external.features));
    dataset.label_dimensions({"row", "feature"});
    return;
  }
  describe_columns(dataset, target.state_channels);
  dataset.set_attribute("dt", target.dt);
  dataset.set_attribute("store_every", study.simulator.store_every);
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

void create_row_datasets(h5::File& file, const Study& study, Index num_rows) {
  const auto dimension = static_cast<Index>(study.prior.size());
  h5::Dataset theta = file.create_dataset("theta", h5::ElementType::f64, {num_rows, dimension});
  describe_theta(theta, study.prior);
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

}  // namespace

void create_simulation_datasets(h5::File& file, const Study& study, const Target& target,
                                Index num_rows) {
  create_row_datasets(file, study, num_rows);
  h5::Dataset values = file.create_dataset(values_name(study), h5::ElementType::f32,
                                           values_shape(study, target, num_rows), kTrajectories);
  describe_values(values, study, target);
}

h5::Dataset simulated_values(const h5::File& file) {
  return file.dataset(file.has("x") ? "x" : "trajectories");
}

std::vector<std::uint8_t> as_bytes(const std::vector<sim::RolloutStatus>& status) {
  std::vector<std::uint8_t> bytes;
  for (const sim::RolloutStatus s : status) bytes.push_back(static_cast<std::uint8_t>(s));
  return bytes;
}

Identity shard_identity(const Identity& simulation, RowRange rows) {
  Identity identity = simulation;
  identity.key_document = key_document(kSimulationShardSchema);
  identity.key_document["simulation"] = simulation.key();
  identity.key_document["begin"] = rows.begin;
  identity.key_document["end"] = rows.end;
  return identity;
}

void join_shards(const ArtefactFile& simulation, const Identity& identity, const Study& study,
                 const Target& target, const std::vector<Shard>& shards) {
  const Index n = shards.back().rows.end;
  ArtefactWriter writer(simulation.path, kSimulationSchema, identity);
  h5::File& file = writer.file();
  create_row_datasets(file, study, n);
  std::vector<h5::VirtualSource> sources;
  ShardLedger ledger;
  Index num_failed = 0;
  for (const Shard& part : shards) {
    const h5::File shard =
        open_artefact(part.path, kSimulationShardSchema, shard_identity(identity, part.rows).key());
    const Index failed = copy_rows(shard, file, part.rows);
    num_failed += failed;
    ledger.add(shard, part.rows, failed);
    writer.add_cost(provenance_of(shard).cost);
    sources.push_back({simulation.key + "/" + part.path.filename().string(), values_name(study),
                       part.rows.size()});
  }
  h5::Dataset values = file.create_virtual_dataset(values_name(study), h5::ElementType::f32,
                                                   values_shape(study, target, n), sources);
  describe_values(values, study, target);
  file.set_attribute("num_failed", num_failed);
  ledger.write(file);
  writer.finish();
}

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

}  // namespace npdr::pipeline
