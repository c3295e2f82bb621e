#include "pipeline/apps/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "core/error.h"
#include "core/random.h"
#include "inference/prior.h"
#include "pipeline/apps/verified_rows.h"
#include "pipeline/artefacts/proposal_file.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/config/study_fields.h"
#include "pipeline/config/study_json.h"
#include "pipeline/plan/plan.h"
#include "pipeline/process/forked_trial.h"
#include "pipeline/sources/source.h"
#include "sim/simulator.h"

namespace npdr::pipeline {
namespace {

// Equal bits; two NaN are equal whatever their payload.
bool same(std::span<const float> a, const RowMatrixF& b) {
  return std::equal(a.begin(), a.end(), b.data(), b.data() + b.size(), [](float x, float y) {
    return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y) || (x != x && y != y);
  });
}

Target target_of(const std::filesystem::path& simulation, const ArtefactInfo& info) {
  return read_recording(
      WorkFolder::beside(simulation, "target", input_key(simulation, info, "target")));
}

// The round of a simulation's proposal, in the cache beside it.
Index round_of(const std::filesystem::path& simulation, const ArtefactInfo& info) {
  const auto path =
      WorkFolder::beside(simulation, "propose", input_key(simulation, info, "proposal"));
  return count_of(path, read_artefact_info(path).identity.key_document, "round");
}

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

// Rows [begin, ...) of which simulation, and the random numbers of the first.
StreamId first_stream(const std::filesystem::path& path, const ArtefactInfo& info) {
  const auto begin =
      static_cast<std::uint64_t>(count_of(path, info.identity.key_document, "begin", 0));
  const auto round = static_cast<std::uint64_t>(round_of(simulation_of(path, info), info));
  return {info.identity.seed, kSimulationStream, round, begin, 0};
}

void check_shape(const std::filesystem::path& path, const Study& study, const StoredRows& rows) {
  const bool gives_motion = study.source().gives_motion;
  const std::size_t rank = gives_motion ? 4 : 2;
  const h5::Shape& shape = rows.shape();
  const bool fits = shape.size() == rank && rows.num_parameters() == std::ssize(study.prior) &&
                    (gives_motion || shape[1] == std::ssize(study.external.features));
  if (!fits) throw InputError(path.string() + ": its rows aren't those of its study");
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
                            ? target_of(simulation_of(path, info), info).first(rows.shape()[1])
                            : Target{};
  const ProposedRows proposed(path, info);
  const StreamId first = traits.takes_seeds ? first_stream(path, info) : StreamId{};
  const auto source = followed(path, [&] { return make_source(study); });
  const auto simulator = followed(
      path, [&] { return source->open({.simulator = study.simulator, .target = target}); });

  const PickedRows picked(rows.num_rows(), options);
  Verification result{rows.num_rows(), picked.size(), {}};
  for (Index i = 0; i < picked.size(); ++i) {
    const Index row = picked[i];
    StreamId id = first;
    id.row += static_cast<std::uint64_t>(row);
    const RowMatrix theta = rows.theta(row);
    const sim::Trajectories again = followed(
        path, [&] { return simulator->simulate(source->parameters().complete(theta.row(0)), id); });
    const bool is_good = same(again.values, rows.values(row)) &&
                         as_bytes(again.status).front() == rows.status(row) &&
                         theta == proposed.theta(row);
    if (!is_good) result.different.push_back(row);
  }
  return result;
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
  const PickedRows picked(theta.num_rows(), options);
  Verification result{theta.num_rows(), picked.size(), {}};
  const Use use{"", info.identity.seed, count_of(path, document, "round", 1),
                count_of(path, document, "iteration", 0)};
  const std::uint64_t round = use.stream_round();
  for (Index i = 0; i < picked.size(); ++i) {
    const Index row = picked[i];
    Stream stream({info.identity.seed, "prior", round, static_cast<std::uint64_t>(row), 0});
    if (prior.sample(stream).transpose() != row_of<double>(theta, row))
      result.different.push_back(row);
  }
  return result;
}

bool is_simulation(const ArtefactInfo& info) {
  return info.schema.name == kSimulationSchema.name ||
         info.schema.name == kSimulationShardSchema.name;
}

// All that is read of the file, and of the proposal beside it. Anybody may have made them, and some
// crash HDF5: a child goes first.
void read_all(const std::filesystem::path& path, const VerifyOptions& options) {
  const ArtefactInfo info = read_artefact_info(path);
  if (is_simulation(info)) {
    const StoredRows rows(path, info);
    const PickedRows picked(rows.num_rows(), options);
    for (Index i = 0; i < picked.size(); ++i) {
      rows.theta(picked[i]), rows.values(picked[i]), rows.status(picked[i]);
    }
    const ProposedRows proposed(path, info);
    for (Index i = 0; i < picked.size(); ++i) proposed.theta(picked[i]);
  }
  if (info.schema.name == kProposalSchema.name) {
    const h5::Dataset theta = open_proposal(path);
    const PickedRows picked(theta.num_rows(), options);
    for (Index i = 0; i < picked.size(); ++i) row_of<double>(theta, picked[i]);
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
