#include "pipeline/artefacts/asked_rows_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/artefacts/layout_tables.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/store/content_key.h"
#include "pipeline/store/hash.h"

namespace npdr::pipeline {
namespace {

constexpr std::size_t kKeyDigits = 16;
constexpr std::string_view kAsked = "asked-", kRows = "rows-", kExtension = ".h5";

void describe(Layout f, AskedRows& asked) {
  f.attribute("first", asked.first, "number of the first row, counted over the refinement");
  f.attribute("shard_size", asked.shard_size, "rows that are simulated together");
  f("theta", asked.theta, {{"n"}, {"D"}}, "rows whose likelihood is wanted", kFinite);
}

void describe(Layout f, RowLikelihoods& likelihoods) {
  f.attribute("num_failed", likelihoods.num_failed, "of these rows couldn't be simulated");
  f("log_likelihood", likelihoods.log_likelihood, {{"m"}}, "of each row [nats]");
}

// The numbers of "PREFIX1-2-...EXTENSION"; none: it isn't such a name.
std::vector<std::string> parts_of(const std::string& name, std::string_view prefix) {
  if (!name.starts_with(prefix) || !name.ends_with(kExtension)) return {};
  return split(name.substr(prefix.size(), name.size() - prefix.size() - kExtension.size()), '-');
}

std::optional<Index> first_of_asked(const std::string& name) {
  const std::vector<std::string> parts = parts_of(name, kAsked);
  return parts.size() == 2 ? parse_count(parts.front()) : std::nullopt;
}

nlohmann::ordered_json document_of(const AskedRows& asked, RowRange rows,
                                   const std::string& posterior) {
  Hasher theta;
  theta.add_bytes(asked.theta.row(rows.begin).data(),
                  sizeof(double) * static_cast<std::size_t>(rows.size() * asked.theta.cols()));
  nlohmann::ordered_json document = key_document(kRowLikelihoodsSchema);
  document["posterior"] = posterior;
  document["begin"] = asked.first + rows.begin;
  document["end"] = asked.first + rows.end;
  document["theta"] = theta.hex();
  return document;
}

}  // namespace

std::string AskedRows::file_name() const {
  return fmt::format("{}{}-{}{}", kAsked, first, end(), kExtension);
}

void write_asked_rows(const std::filesystem::path& folder, const Identity& posterior,
                      AskedRows asked) {
  ArtefactWriter writer(folder / asked.file_name(), kAskedRowsSchema, posterior);
  describe(Layout::writer(writer.file()), asked);
  writer.finish();
}

std::optional<AskedRows> read_asked_rows(const ArtefactFile& artefact) {
  const std::optional<h5::File> file = open_artefact_if_there(artefact, kAskedRowsSchema);
  if (!file) return std::nullopt;
  AskedRows asked;
  describe(Layout::reader(*file), asked);
  if (asked.first < 0 || asked.shard_size < 1) {
    throw InputError(fmt::format(
        "{}: asks for rows from {} on in shards of {}, must be >= 0 and >= 1; remove this file",
        artefact.path.string(), asked.first, asked.shard_size));
  }
  return asked;
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

void write_row_likelihoods(h5::File& file, RowLikelihoods likelihoods) {
  describe(Layout::writer(file), likelihoods);
}

std::optional<RowLikelihoods> read_row_likelihoods(const std::filesystem::path& folder,
                                                   const AskedShard& shard) {
  const ArtefactFile artefact(folder / shard.file_name, shard.key);
  const std::optional<h5::File> file = open_artefact_if_there(artefact, kRowLikelihoodsSchema);
  if (!file) return std::nullopt;
  RowLikelihoods likelihoods;
  describe(Layout::reader(*file), likelihoods);
  const Index count = shard.rows.size();
  if (likelihoods.log_likelihood.size() != count || likelihoods.num_failed < 0 ||
      likelihoods.num_failed > count) {
    throw InputError(fmt::format(
        "{}: {} likelihoods and {} failed rows, must be of {} rows; "
        "remove this file",
        artefact.path.string(), likelihoods.log_likelihood.size(), likelihoods.num_failed, count));
  }
  likelihoods.cost = provenance_of(*file).cost;
  return likelihoods;
}

std::optional<Index> end_of_rows(const std::string& file_name) {
  const std::vector<std::string> parts = parts_of(file_name, kRows);
  return parts.size() == 3 ? parse_count(parts[1]) : std::nullopt;
}

void list_asked_rows(Layout f) {
  AskedRows asked;
  describe(f, asked);
}

void list_row_likelihoods(Layout f) {
  RowLikelihoods likelihoods;
  describe(f, likelihoods);
}

}  // namespace npdr::pipeline
