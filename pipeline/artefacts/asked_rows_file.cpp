#include "pipeline/artefacts/asked_rows_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/text.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/process/build_info.h"
#include "pipeline/store/hash.h"

namespace npdr::pipeline {
namespace {

constexpr std::size_t kKeyDigits = 16;
constexpr Index kMostRows = 1'000'000'000'000;
constexpr std::string_view kAsked = "asked-", kRows = "rows-", kExtension = ".h5";

// The numbers of "PREFIX1-2-...EXTENSION"; none: it isn't such a name.
std::vector<std::string> parts_of(const std::string& name, std::string_view prefix) {
  if (!name.starts_with(prefix) || !name.ends_with(kExtension)) return {};
  return split(name.substr(prefix.size(), name.size() - prefix.size() - kExtension.size()), '-');
}

std::optional<Index> first_of_asked(const std::string& name) {
  const std::vector<std::string> parts = parts_of(name, kAsked);
  return parts.size() == 3 ? parse_count(parts.front()) : std::nullopt;
}

void add(const RowMatrix& values, Hasher& hasher) {
  hasher.add_bytes(values.data(), sizeof(double) * static_cast<std::size_t>(values.size()));
}

nlohmann::ordered_json document_of(const AskedRows& asked, RowRange rows,
                                   const std::string& posterior) {
  Hasher theta, first_errors;
  theta.add_bytes(asked.theta.row(rows.begin).data(),
                  sizeof(double) * static_cast<std::size_t>(rows.size() * asked.theta.cols()));
  add(asked.first_errors, first_errors);
  nlohmann::ordered_json document = key_document(kSimulatedRowsSchema);
  document["posterior"] = posterior;
  document["begin"] = asked.first + rows.begin;
  document["end"] = asked.first + rows.end;
  document["theta"] = theta.hex();
  document["first_errors"] = first_errors.hex();
  document["rollouts"] = asked.rollouts;
  document["instruction_set"] = instruction_set();  // another one rounds differently
  return document;
}

}  // namespace

void describe(Layout f, AskedRows& asked) {
  f.attribute("first", asked.first, "number of the first row, counted over the refinement");
  f.attribute("shard_size", asked.shard_size, "rows that are simulated together");
  f.attribute("rollouts", asked.rollouts, "1: wanted as well; 0: likelihoods alone");
  f("theta", asked.theta, {{"n"}, {"D"}}, "rows that are wanted", kFinite);
  f("first_errors", asked.first_errors, {{"S"}, {"C"}},
    "of the noise, over its unit, that simulations of segments begin without; missing where first "
    "states aren't inferred",
    {.allowed = h5::Values::finite, .unless_empty = true});
  if (!f.reads()) return;
  if (asked.first < 0 || asked.first > kMostRows || asked.shard_size < 1) {
    throw InputError(
        fmt::format("{}: asks for rows from {} on in shards of {}, must be from 0 to {} "
                    "and >= 1; remove this file",
                    f.where(), asked.first, asked.shard_size, kMostRows));
  }
}

void describe(Layout f, SimulatedRows& rows) {
  f.attribute("num_failed", rows.num_failed, "of these rows couldn't be simulated");
  f("log_likelihood", rows.log_likelihood, {{"m"}}, "of each row [nats]");
  sim::Trajectories& t = rows.rollouts;
  f.attribute("num_rollouts", t.num_rollouts, "H of each row; 0: they weren't asked for");
  f.attribute("num_steps", t.num_steps, "K, stored states of a rollout");
  f.attribute("num_states", t.num_states, "C, state channels");
  if (f.reads()) {
    f.bind("H", t.num_rollouts);
    f.bind("K", t.num_steps);
    f.bind("C", t.num_states);
  }
  f("rollouts", t.values, {{"m"}, {"H"}, {"K"}, {"C"}}, "NaN where a row failed",
    {.unless_empty = true,
     .storage = kFastest,
     .shape = {t.num_rows, t.num_rollouts, t.num_steps, t.num_states}});
  std::vector<std::uint8_t> status = as_bytes(t.status);
  f("status", status, {{"m"}}, "0: ok, else how the row failed", {.unless_empty = true});
  if (!f.reads()) return;
  t.num_rows = std::ssize(status);
  for (const std::uint8_t s : status) t.status.push_back(static_cast<sim::RolloutStatus>(s));
}

std::string AskedRows::file_name() const {
  Hasher what;
  add(theta, what);
  add(first_errors, what);
  what.add_bytes(&shard_size, sizeof(shard_size));
  what.add_bytes(&rollouts, sizeof(rollouts));
  return fmt::format("{}{}-{}-{}{}", kAsked, first, end(), what.hex().substr(0, kKeyDigits),
                     kExtension);
}

std::vector<std::string> names_of_asked_rows(const std::set<std::string>& names) {
  std::vector<std::string> found;
  std::ranges::copy_if(names, std::back_inserter(found),
                       [](const std::string& name) { return first_of_asked(name).has_value(); });
  std::ranges::stable_sort(found, {}, first_of_asked);
  return found;
}

std::vector<AskedShard> shards_of(const AskedRows& asked, const std::string& posterior) {
  std::vector<AskedShard> shards;
  const Index n = asked.theta.rows();
  for (Index begin = 0; begin < n; begin += asked.shard_size) {
    const RowRange rows{begin, begin + std::min(asked.shard_size, n - begin)};
    std::string key = content_key(document_of(asked, rows, posterior));
    std::string name = fmt::format("{}{}-{}-{}{}", kRows, asked.first + rows.begin,
                                   asked.first + rows.end, key.substr(0, kKeyDigits), kExtension);
    shards.push_back({rows, std::move(key), std::move(name)});
  }
  return shards;
}

Identity identity_of(const AskedRows& asked, const AskedShard& shard, const Identity& posterior) {
  Identity identity = posterior;
  identity.key_document = document_of(asked, shard.rows, posterior.key());
  return identity;
}

std::optional<SimulatedRows> read_simulated_rows(const std::filesystem::path& folder,
                                                 const AskedShard& shard) {
  const ArtefactFile artefact(folder / shard.file_name, shard.key);
  std::optional<SimulatedRows> rows = kSimulatedRowsSchema.read_if_there(artefact);
  if (!rows) return std::nullopt;
  const Index count = shard.rows.size();
  const sim::Trajectories& t = rows->rollouts;
  const bool has_rollouts = t.num_rollouts > 0 && !t.values.empty();
  if (rows->log_likelihood.size() != count || rows->num_failed < 0 || rows->num_failed > count ||
      t.num_rows != (has_rollouts ? count : 0)) {
    throw InputError(fmt::format(
        "{}: {} likelihoods, {} failed rows and rollouts of {}, must be of "
        "{} rows; remove this file",
        artefact.path.string(), rows->log_likelihood.size(), rows->num_failed, t.num_rows, count));
  }
  return rows;
}

std::optional<Index> end_of_rows(const std::string& file_name) {
  const std::vector<std::string> parts = parts_of(file_name, kRows);
  return parts.size() == 3 ? parse_count(parts[1]) : std::nullopt;
}

}  // namespace npdr::pipeline
