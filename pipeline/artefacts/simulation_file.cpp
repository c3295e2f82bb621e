#include "pipeline/artefacts/simulation_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <span>

#include "core/feature_names.h"
#include "core/text.h"

namespace npdr::pipeline {
namespace {

const char* values_name(const Study& study) {
  return study.source().gives_motion ? "trajectories" : "x";
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

void describe_rows(Layout f, const std::vector<inference::Marginal>& prior, Index num_rows) {
  const Dim row{"N", "row"};
  f.rows_later<double>("theta", {num_rows, std::ssize(prior)}, {row, kParameter},
                       "the parameters of each row")
      .columns(prior);
  f.rows_later<std::uint8_t>("status", {num_rows}, {row}, "0: ok, else how the row failed")
      .attribute("meaning", status_meanings(), "`0 ok`, `1 diverged`, ...");
  f.rows_later<float>("seconds", {num_rows}, {row},
                      "time that the row took: that of its block of rows, shared evenly")
      .attribute("volatile", Index{1}, "1: not part of the digest");
}

void describe_x(Layout f, const h5::Shape& shape, const std::vector<Channel>& features,
                const std::vector<h5::VirtualSource>& sources) {
  f.rows_later<float>("x", shape, {{"N", "row"}, kFeature},
                      "in place of `trajectories` where the simulator is a command or a dataset: "
                      "features; NaN throughout a row that failed",
                      kFastest, sources)
      .columns(features);
}

void describe_trajectories(Layout f, const h5::Shape& shape, const Target& target,
                           Index store_every, const std::vector<h5::VirtualSource>& sources) {
  Layout trajectories = f.rows_later<float>(
      "trajectories", shape, {{"N", "row"}, {"H", "rollout"}, {"T'", "time"}, {"C", "channel"}},
      "states after every `store_every`-th step; NaN throughout a row that failed", kFastest,
      sources);
  trajectories.columns(target.state_channels);
  trajectories.attribute("dt", double{target.dt}, "of the target [s]");
  trajectories.attribute("store_every", store_every, "of the simulator");
}

void describe_values(Layout f, const Study& study, const Target& target, Index num_rows,
                     const std::vector<h5::VirtualSource>& sources = {}) {
  if (study.source().gives_motion) {
    const Index every = study.simulator.store_every;
    describe_trajectories(
        f, {num_rows, target.num_rollouts(), target.num_steps() / every, target.num_states()},
        target, every, sources);
  } else {
    describe_x(f, {num_rows, std::ssize(study.external.features)},
               parse_features(study.external.features), sources);
  }
}

// A shard, and who made it.
struct MadeShard {
  RowRange rows;
  Index num_failed = 0;
  Provenance by;
};

// Describes what only the joined file has.
void describe(Layout f, const std::vector<MadeShard>& shards, Index num_failed) {
  f.attribute("num_failed", num_failed, "of the joined file: rows whose status isn't 0");
  Layout group = f.group("shards");
  group.attribute("volatile", Index{1}, "1: not part of the digest; of the joined file only");
  const auto column = [&](const char* name, const char* meaning, const auto& of) {
    std::vector<decltype(of(MadeShard{}))> values;
    std::ranges::transform(shards, std::back_inserter(values), of);
    group(name, values, {{"S"}}, meaning);
  };
  using Made = const MadeShard&;
  column("begin", "who made which rows: the first", [](Made s) { return s.rows.begin; });
  column("end", "the one after the last", [](Made s) { return s.rows.end; });
  column("failed", "how many failed", [](Made s) { return s.num_failed; });
  column("host", "machine", [](Made s) { return s.by.host; });
  column("batch_job", "of the batch system; empty without one",
         [](Made s) { return s.by.batch_job; });
  column("wall_seconds", "that it took", [](Made s) { return s.by.cost.wall_seconds; });
  column("core_seconds", "that times the threads", [](Made s) { return s.by.cost.core_seconds; });
}

void describe_warnings(Layout f, std::vector<std::string> warnings) {
  Layout group = f.group("findings");
  group.attribute("volatile", Index{1}, "1: not part of the digest");
  group.attribute(
      "warnings", warnings,
      "what is probably wrong with the rows, where all of them, calls, or a few rows that were "
      "asked for again say so");
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

void describe(Layout f, Proposal& proposal) {
  f("theta", proposal.theta, {{"N", "row"}, kParameter},
    "parameters; bounds of the prior's support are infinite where it has none")
      .columns(proposal.parameters);
}

h5::Dataset open_proposal(const ArtefactFile& proposal) {
  h5::Dataset theta = open_artefact(proposal, kProposalSchema).dataset("theta");
  theta.require_shape({-1, -1});
  return theta;
}

RowMatrix read_proposal(const h5::Dataset& theta, RowRange rows) {
  RowMatrix values(rows.size(), theta.row_size());
  const std::span<double> all(values.data(), static_cast<std::size_t>(values.size()));
  theta.read_rows<double>(rows.begin, values.rows(), all);
  theta.require_finite<double>(all);
  return values;
}

void create_simulation_datasets(h5::File& file, const Study& study, const Target& target,
                                Index num_rows) {
  const Layout f = Layout::writer(file);
  describe_rows(f, study.prior, num_rows);
  describe_values(f, study, target, num_rows);
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
                 const Target& target, const std::vector<Shard>& shards,
                 std::vector<std::string> warnings) {
  const Index n = shards.back().rows.end;
  ArtefactWriter writer(simulation.path, kSimulationSchema, identity);
  h5::File& file = writer.file();
  const Layout f = Layout::writer(file);
  describe_rows(f, study.prior, n);
  std::vector<h5::VirtualSource> sources;
  std::vector<MadeShard> made;
  Index num_failed = 0;
  for (const Shard& part : shards) {
    const h5::File shard = open_artefact({part.path, shard_identity(identity, part.rows).key()},
                                         kSimulationShardSchema);
    const Provenance provenance = provenance_of(shard);
    made.push_back({part.rows, copy_rows(shard, file, part.rows), provenance});
    num_failed += made.back().num_failed;
    std::ranges::copy(warnings_of(shard), std::back_inserter(warnings));
    writer.add_cost(provenance.cost);
    sources.push_back({simulation.key + "/" + part.path.filename().string(), values_name(study),
                       part.rows.size()});
  }
  describe_values(f, study, target, n, sources);
  describe(f, made, num_failed);
  write_warnings(file, warnings);
  writer.finish();
}

void write_warnings(h5::File& file, const std::vector<std::string>& warnings) {
  if (!warnings.empty()) describe_warnings(Layout::writer(file), warnings);
}

std::vector<std::string> warnings_of(const h5::File& file) {
  if (!file.has("findings")) return {};
  return file.group("findings").attribute<std::vector<std::string>>("warnings");
}

std::string failures(const h5::File& simulation) {
  const auto rows = simulation.dataset("status").read<std::uint8_t>();
  std::map<std::uint8_t, Index> counts;
  for (const std::uint8_t s : rows) ++counts[s];
  std::vector<std::string> parts;
  for (const auto& [status, count] : counts) {
    if (status == 0) continue;
    parts.push_back(
        fmt::format("{} {}", count, sim::to_string(static_cast<sim::RolloutStatus>(status))));
  }
  const double share = 1.0 - static_cast<double>(counts[0]) / static_cast<double>(std::ssize(rows));
  return fmt::format("{:.3g} %: {}", 100.0 * share, join(parts));
}

void list_simulation(Layout f) {
  describe_rows(f, {}, 0);
  describe_trajectories(f, {}, {}, 1, {});
  describe_x(f, {}, {}, {});
  describe(f, std::vector<MadeShard>(), 0);
  describe_warnings(f, {});
}

}  // namespace npdr::pipeline
