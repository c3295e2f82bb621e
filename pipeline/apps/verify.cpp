#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <optional>

#include "core/error.h"
#include "core/random.h"
#include "core/text.h"
#include "inference/prior.h"
#include "pipeline/apps/commands.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/config/study_fields.h"
#include "pipeline/config/study_json.h"
#include "pipeline/plan/plan.h"
#include "pipeline/process/forked_trial.h"
#include "pipeline/sources/source.h"
#include "pipeline/store/artefact.h"
#include "sim/simulator.h"

namespace npdr::pipeline {
namespace {

// Equal bits; two NaN are equal whatever their payload.
bool same(std::span<const float> a, const RowMatrixF& b) {
  return std::equal(a.begin(), a.end(), b.data(), b.data() + b.size(), [](float x, float y) {
    return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y) || (x != x && y != y);
  });
}

// The key of an input that the artefact names, which anybody may have written.
std::string input_key(const std::filesystem::path& path, const ArtefactInfo& info,
                      const std::string& name) {
  const auto found = info.identity.inputs.find(name);
  if (found == info.identity.inputs.end()) {
    throw InputError(path.string() + ": names no input '" + name +
                     "': no stage made it; rerun stage '" + info.schema.stage + "'");
  }
  return found->second;
}

// A number of a document that counts something; `otherwise` where it isn't there.
Index count_of(const std::filesystem::path& path, const nlohmann::ordered_json& document,
               const std::string& name, std::optional<Index> otherwise = {}) {
  constexpr Index most = 1'000'000'000;
  if (otherwise && !document.contains(name)) return *otherwise;
  const auto& value = document.at(name);
  const bool is_count = value.is_number_integer() && value >= 0 && value <= most;
  if (!is_count) {
    throw InputError(fmt::format("{}: key_document: {} = {}, must be a whole number from 0 to {}",
                                 path.string(), name, shortened(value.dump()), most));
  }
  return value.get<Index>();
}

// One row of a dataset (N, ...).
template <class T>
RowMatrixX<T> row_of(const h5::Dataset& dataset, Index row) {
  RowMatrixX<T> values(1, dataset.row_size());
  dataset.read_rows<T>(row, 1, {values.data(), static_cast<std::size_t>(values.size())});
  return values;
}

// Looks at as many of the rows as are asked for, one after the other: a file of any size takes
// little memory. `is_same`: whether a row is as it should be.
template <class IsSame>
Verification look_at_rows(Index num_rows, const VerifyOptions& options, const IsSame& is_same) {
  Verification result{num_rows, std::min(options.count, num_rows), {}};
  std::vector<std::uint32_t> picked;  // empty: all
  if (result.num_checked < num_rows) {
    Stream stream({options.pick, "verify", 0, 0, 0});
    const auto order = stream.permutation(static_cast<std::uint32_t>(num_rows));
    picked.assign(order.begin(), order.begin() + result.num_checked);
    std::ranges::sort(picked);
  }
  for (Index i = 0; i < result.num_checked; ++i) {
    const Index row = picked.empty() ? i : picked[static_cast<std::size_t>(i)];
    if (!is_same(row)) result.different.push_back(row);
  }
  return result;
}

bool is_shard(const ArtefactInfo& info) { return info.schema.name == kSimulationShardSchema.name; }

bool is_simulation(const ArtefactInfo& info) {
  return info.schema.name == kSimulationSchema.name || is_shard(info);
}

// A file that an artefact names as its input, in the cache beside it: beside the joined file, where
// the artefact is a shard.
std::filesystem::path input_of(const std::filesystem::path& path, const ArtefactInfo& info,
                               const char* name, Stage stage) {
  const std::filesystem::path joined =
      is_shard(info) ? path.parent_path().string() + ".h5" : path.string();
  return WorkFolder::beside(joined, name_of(stage), input_key(path, info, name));
}

// Rows of a simulation, or of one of its shards, as they are stored.
struct StoredRows {
  StoredRows(const std::filesystem::path& path, const ArtefactInfo& info)
      : file(open_artefact(path, is_shard(info) ? kSimulationShardSchema : kSimulationSchema)),
        values(simulated_values(file)),
        theta(file.dataset("theta")),
        status(file.dataset("status")) {
    theta.require_shape({values.num_rows(), -1});
    status.require_shape({values.num_rows()});
  }

  h5::File file;
  h5::Dataset values, theta, status;
};

// theta of the same rows as they were proposed: those of a shard are some of its simulation's.
struct ProposedRows {
  ProposedRows(const std::filesystem::path& path, const ArtefactInfo& info)
      : file{input_of(path, info, "proposal", Stage::propose), input_key(path, info, "proposal")},
        all(open_proposal(file)),
        begin(count_of(path, info.identity.key_document, "begin", 0)) {}

  RowMatrix theta(Index row) const { return read_proposal(all, {begin + row, begin + row + 1}); }

  ArtefactFile file;
  h5::Dataset all;
  Index begin;  // the simulation's first row in it
};

// Escapes of JSON: what a file holds could otherwise rewrite the terminal's lines.
std::string shown(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

// What the file would have us run; none: nothing that isn't ours.
std::string foreign_code(const ExternalConfig& external) {
  const std::string where = " in the folder " + shown(external.folder);
  switch (external.kind()) {
    case SourceKind::command:
    case SourceKind::motion_command:
      return "the command " + shown(*external.command) + where;
    case SourceKind::worker:
      return "the worker " + shown(*external.worker) + where;
    case SourceKind::library:
      return "the library " + shown(*external.library);
    default:
      return "";
  }
}

void require_trust(const std::filesystem::path& path, const Study& study,
                   const VerifyOptions& options) {
  const std::string code = foreign_code(study.external);
  if (code.empty() || options.runs_command) return;
  throw InputError(path.string() + ": to make its rows again runs, with your rights, " + code +
                   ", as whoever made the file says; add --run-command if you trust them");
}

// Where the study's folder has been moved, `file` may lie in the current one.
void find_moved(std::optional<std::string>& file) {
  std::error_code error;
  if (!file || std::filesystem::exists(*file, error)) return;
  const std::filesystem::path name = std::filesystem::path(*file).filename();
  if (std::filesystem::exists(name, error)) file = name.string();
}

// The study as far as its source needs it.
Study study_of(const std::filesystem::path& path, const ArtefactInfo& info,
               const VerifyOptions& options) {
  const auto& json = info.identity.study;
  const auto table =
      from_json<SimulatorTable>(json.at("simulator"), path.string() + ": study.simulator");
  Study study;
  study.simulator = table.built_in;
  study.external = table.external;
  study.prior = prior_from_json(json.at("prior"), path.string());
  find_moved(study.external.library);
  find_moved(study.external.mjcf);
  require_trust(path, study, options);
  return study;
}

[[noreturn]] void reject_dataset(const std::filesystem::path& path) {
  throw InputError(path.string() +
                   ": its rows are those of a dataset; only simulations can be recomputed");
}

void check_shape(const std::filesystem::path& path, const Study& study, const StoredRows& rows) {
  const bool gives_motion = study.source().gives_motion;
  const std::size_t rank = gives_motion ? 4 : 2;
  const h5::Shape& shape = rows.values.shape();
  const bool fits = shape.size() == rank && rows.theta.row_size() == std::ssize(study.prior) &&
                    (gives_motion || shape[1] == std::ssize(study.external.features));
  if (!fits) throw InputError(path.string() + ": its rows aren't those of its study");
}

// Does what documents of the file say: who can't learns from which file that comes.
template <class Follow>
auto followed(const std::filesystem::path& path, const Follow& follow) {
  try {
    return follow();
  } catch (const InputError& error) {
    throw InputError(path.string() +
                     ": what its key document and study say can't be done: " + error.what());
  }
}

// Each row in a call of its own.
Verification verify_simulation(const std::filesystem::path& path, const ArtefactInfo& info,
                               const VerifyOptions& options) {
  const StoredRows rows(path, info);
  const Study study = study_of(path, info, options);
  const SourceTraits& traits = study.source();
  if (!traits.simulates) reject_dataset(path);
  check_shape(path, study, rows);
  // A shard's own document doesn't hold the number of rollouts; its trajectories do.
  const Target target = traits.gives_motion
                            ? read_recording(input_of(path, info, "target", Stage::target))
                                  .first(rows.values.shape()[1])
                            : Target{};
  const ProposedRows proposed(path, info);
  StreamId first{info.identity.seed, kSimulationStream, 0, 0, 0};
  if (traits.takes_seeds) {
    const auto document = read_artefact_info(proposed.file.path).identity.key_document;
    first.round = static_cast<std::uint64_t>(count_of(proposed.file.path, document, "round"));
    first.row = static_cast<std::uint64_t>(proposed.begin);
  }
  const auto source = followed(path, [&] { return make_source(study); });
  const auto simulator = followed(
      path, [&] { return source->open({.simulator = study.simulator, .target = target}); });
  return look_at_rows(rows.values.num_rows(), options, [&](Index row) {
    const RowMatrix theta = row_of<double>(rows.theta, row);
    const sim::Trajectories again = followed(path, [&] {
      return simulator->simulate(source->parameters().complete(theta.row(0)),
                                 row_after(first, row));
    });
    return same(again.values, row_of<float>(rows.values, row)) &&
           as_bytes(again.status).front() == row_of<std::uint8_t>(rows.status, row)(0) &&
           theta == proposed.theta(row);
  });
}

Verification verify_proposal(const std::filesystem::path& path, const ArtefactInfo& info,
                             const VerifyOptions& options) {
  const h5::File file = open_artefact(path, kProposalSchema);
  const auto& document = info.identity.key_document;
  if (document.contains("dataset")) reject_dataset(path);
  if (!document.contains("prior")) {
    throw InputError(path.string() +
                     ": its rows come from a posterior; only those of the prior can be recomputed");
  }
  const auto marginals = prior_from_json(document.at("prior"), path.string());
  const inference::Prior prior = followed(path, [&] { return inference::Prior(marginals); });
  const h5::Dataset theta = file.dataset("theta");
  theta.require_shape({-1, prior.dimension()});
  const Use use{"", info.identity.seed, count_of(path, document, "round", 1),
                count_of(path, document, "iteration", 0)};
  return look_at_rows(theta.num_rows(), options, [&](Index row) {
    Stream stream(
        {info.identity.seed, "prior", use.stream_round(), static_cast<std::uint64_t>(row), 0});
    return prior.sample(stream).transpose() == row_of<double>(theta, row);
  });
}

// All that is read of the file, and of the proposal beside it. Anybody may have made them, and some
// crash HDF5: a child goes first.
void read_all(const std::filesystem::path& path, const VerifyOptions& options) {
  const ArtefactInfo info = read_artefact_info(path);
  if (is_simulation(info)) {
    const StoredRows rows(path, info);
    const ProposedRows proposed(path, info);
    look_at_rows(rows.values.num_rows(), options, [&](Index row) {
      row_of<double>(rows.theta, row), row_of<float>(rows.values, row);
      row_of<std::uint8_t>(rows.status, row), proposed.theta(row);
      return true;
    });
  }
  if (info.schema.name == kProposalSchema.name) {
    const h5::Dataset theta = open_proposal({path});
    look_at_rows(theta.num_rows(), options, [&](Index row) {
      row_of<double>(theta, row);
      return true;
    });
  }
}

// Looks at rows of what has any that can be made one by one.
Verification verify_rows(const std::filesystem::path& path, const ArtefactInfo& info,
                         const VerifyOptions& options) {
  if (is_simulation(info)) return verify_simulation(path, info, options);
  const std::string& schema = info.schema.name;
  if (schema == kProposalSchema.name) return verify_proposal(path, info, options);
  throw InputError(fmt::format(
      "{}: a {}, which has no rows that can be made one by one, as simulations and first proposals "
      "have; add --remake STUDY to make all of it again, which took {:.1f} s "
      "({:.1f} core-seconds), and compare",
      path.string(), schema, info.provenance.cost.wall_seconds, info.provenance.cost.core_seconds));
}

}  // namespace

Verification verify(const std::filesystem::path& given, const VerifyOptions& options) {
  // A link of the readable folder leads to the cache, where the inputs lie.
  const std::filesystem::path path = std::filesystem::weakly_canonical(given);
  try_to_read(path, [&] { read_all(path, options); });
  const ArtefactInfo info = read_artefact_info(path);
  try {
    return verify_rows(path, info, options);
  } catch (const nlohmann::json::exception& error) {
    const std::string message = error.what();
    throw InputError(path.string() + ": its key document or study isn't what stage '" +
                     info.schema.stage + "' writes: " + message.substr(message.find("] ") + 2));
  }
}

}  // namespace npdr::pipeline
