#include "pipeline/apps/verify.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "inference/prior.h"
#include "pipeline/artefacts/policy_outcomes.h"
#include "pipeline/artefacts/proposal_file.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/config/study_fields.h"
#include "pipeline/config/study_json.h"
#include "pipeline/predictions/policy_rollouts.h"
#include "pipeline/process/forked_trial.h"
#include "pipeline/sources/source.h"
#include "sim/simulator.h"

namespace npdr::pipeline {
namespace {

std::vector<Index> pick_rows(Index num_rows, Index count, std::uint64_t pick) {
  Stream stream({pick, "verify", 0, 0, 0});
  const auto order = stream.permutation(static_cast<std::uint32_t>(num_rows));
  std::vector<Index> rows(order.begin(), order.begin() + std::min(count, num_rows));
  std::sort(rows.begin(), rows.end());
  return rows;
}

// Equal bits; two NaN are equal whatever their payload.
bool same(std::span<const float> a, std::span<const float> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](float x, float y) {
    return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y) || (x != x && y != y);
  });
}

// The joined file of a shard, or the file itself.
std::filesystem::path simulation_of(const std::filesystem::path& path, const ArtefactInfo& info) {
  if (info.schema.name != kSimulationShardSchema.name) return path;
  return path.parent_path().string() + ".h5";
}

Target target_of(const std::filesystem::path& simulation, const ArtefactInfo& info) {
  const std::string key = info.identity.inputs.at("target");
  const auto path = simulation.parent_path().parent_path() / "target" / (key + ".h5");
  return read_recording(path);
}

// The round of a simulation's proposal, in the cache beside it.
Index round_of(const std::filesystem::path& simulation, const ArtefactInfo& info) {
  const std::string key = info.identity.inputs.at("proposal");
  const auto path = simulation.parent_path().parent_path() / "propose" / (key + ".h5");
  return read_artefact_info(path).identity.key_document.at("round").get<Index>();
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
  require_trust(path, study, options);
  return study;
}

[[noreturn]] void reject_dataset(const std::filesystem::path& path) {
  throw InputError(path.string() +
                   ": its rows are those of a dataset; only simulations can be recomputed");
}

// Rows [begin, ...) of which simulation, and the random numbers of the first.
StreamId first_stream(const std::filesystem::path& path, const ArtefactInfo& info) {
  const auto& document = info.identity.key_document;
  const auto begin = document.contains("begin") ? document.at("begin").get<std::uint64_t>() : 0;
  const auto round = static_cast<std::uint64_t>(round_of(simulation_of(path, info), info));
  return {info.identity.seed, kSimulationStream, round, begin, 0};
}

// theta of the rows as they were proposed: those of a shard are some of its simulation's.
RowMatrix proposed_rows(const std::filesystem::path& path, const ArtefactInfo& info, Index count) {
  const std::filesystem::path cache = simulation_of(path, info).parent_path().parent_path();
  const std::string key = info.identity.inputs.at("proposal");
  const auto& document = info.identity.key_document;
  const auto begin = document.contains("begin") ? document.at("begin").get<Index>() : 0;
  const h5::Dataset theta = open_proposal({cache / "propose" / (key + ".h5"), key});
  return read_proposal(theta, {begin, begin + count});
}

// Rows of a simulation as they are stored.
struct StoredRows {
  Index num_rows = 0;
  h5::Shape shape;            // of all of its values
  std::vector<Index> picked;  // rows
  RowMatrix theta;            // of those
  RowMatrixF values;
  std::vector<std::uint8_t> status;
};

StoredRows read_rows(const std::filesystem::path& path, const ArtefactInfo& info,
                     const VerifyOptions& options) {
  const bool is_shard = info.schema.name == kSimulationShardSchema.name;
  const h5::File file = open_artefact(path, is_shard ? kSimulationShardSchema : kSimulationSchema);
  const h5::Dataset values = simulated_values(file);
  const RowMatrix theta = file.read_matrix<double>("theta", values.num_rows());
  StoredRows rows{values.num_rows(),
                  values.shape(),
                  pick_rows(values.num_rows(), options.count, options.pick),
                  {},
                  {},
                  {}};
  rows.theta = theta(rows.picked, Eigen::all);
  const auto status = file.dataset("status").read<std::uint8_t>();
  for (const Index row : rows.picked) {
    rows.status.push_back(status.at(static_cast<std::size_t>(row)));
  }
  rows.values.resize(std::ssize(rows.picked), values.row_size());
  for (Index i = 0; i < rows.values.rows(); ++i) {
    values.read_rows<float>(
        rows.picked[static_cast<std::size_t>(i)], 1,
        {rows.values.row(i).data(), static_cast<std::size_t>(values.row_size())});
  }
  return rows;
}

void check_shape(const std::filesystem::path& path, const Study& study, const StoredRows& rows) {
  const bool gives_motion = study.source().gives_motion;
  const std::size_t rank = gives_motion ? 4 : 2;
  const auto num_parameters = static_cast<Index>(study.prior.size());
  const bool fits = rows.shape.size() == rank && rows.theta.cols() == num_parameters &&
                    (gives_motion || rows.shape[1] == std::ssize(study.external.features));
  if (!fits) throw InputError(path.string() + ": its rows aren't those of its study");
}

// Each row in a call of its own.
Verification verify_simulation(const std::filesystem::path& path, const ArtefactInfo& info,
                               const VerifyOptions& options) {
  const StoredRows rows = read_rows(path, info, options);
  const Study study = study_of(path, info, options);
  const SourceTraits& traits = study.source();
  if (!traits.simulates) reject_dataset(path);
  check_shape(path, study, rows);
  // A shard's own document doesn't hold the number of rollouts; its trajectories do.
  const Target target = traits.gives_motion
                            ? target_of(simulation_of(path, info), info).first(rows.shape[1])
                            : Target{};
  const RowMatrix proposed = proposed_rows(path, info, rows.num_rows);
  const StreamId first = traits.takes_seeds ? first_stream(path, info) : StreamId{};
  const auto source = make_source(study);
  const auto simulator = source->open({.simulator = study.simulator, .target = target});

  Verification result;
  result.num_rows = rows.num_rows;
  for (Index i = 0; i < std::ssize(rows.picked); ++i) {
    const Index row = rows.picked[static_cast<std::size_t>(i)];
    StreamId id = first;
    id.row += static_cast<std::uint64_t>(row);
    const sim::Trajectories again =
        simulator->simulate(source->parameters().complete(rows.theta.row(i)), id);
    const std::span<const float> stored(rows.values.row(i).data(),
                                        static_cast<std::size_t>(rows.values.cols()));
    ++result.num_checked;
    const bool ends_alike =
        as_bytes(again.status).front() == rows.status[static_cast<std::size_t>(i)];
    const bool is_proposed = rows.theta.row(i) == proposed.row(row);
    if (!same(again.values, stored) || !ends_alike || !is_proposed) result.different.push_back(row);
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
  const inference::Prior prior(prior_from_json(document.at("prior"), path.string()));
  const RowMatrix theta = file.read_matrix<double>("theta", -1, prior.dimension());
  Verification result;
  result.num_rows = theta.rows();
  const Use use{"", info.identity.seed, document.value("round", Index{1}),
                document.value("iteration", Index{0})};
  const std::uint64_t round = use.stream_round();
  for (const Index row : pick_rows(result.num_rows, options.count, options.pick)) {
    Stream stream({info.identity.seed, "prior", round, static_cast<std::uint64_t>(row), 0});
    ++result.num_checked;
    if (prior.sample(stream).transpose() != theta.row(row)) result.different.push_back(row);
  }
  return result;
}

// The study as far as the test's document tells it.
Study tested_study(const std::filesystem::path& path, const ArtefactInfo& info,
                   const VerifyOptions& options) {
  const auto& document = info.identity.key_document;
  Study study = study_of(path, info, options);
  if (document.contains("truth")) {
    study.target.truth = document.at("truth").get<std::map<std::string, double>>();
  }
  study.policy.num_steps = document.at("task").at("num_steps").get<Index>();
  study.policy.model = document.at("task").at("model").get<std::map<std::string, double>>();
  if (!document.contains("grid")) return study;
  PolicyGrid& grid = study.policy.grid;
  for (std::size_t i = 0; i < 2; ++i) {
    PolicyGridAxis& axis = i == 0 ? grid.x : grid.y;
    axis.parameter = document.at("grid").at(i).at("parameter").get<std::string>();
    axis.values = document.at("grid").at(i).at("values").get<std::vector<double>>();
  }
  return study;
}

// The returns as they are stored: of the target domain, then of the grid.
Vector stored_returns(const PolicyTest& test) {
  Vector all;
  for (const auto& part : {test.target, test.grid}) {
    if (!part) continue;
    const Index before = all.size();
    all.conservativeResize(before + part->returns.size());
    all.tail(part->returns.size()) = part->returns.reshaped<Eigen::RowMajor>();
  }
  return all;
}

// Rollouts, each on its own.
Verification verify_policy_test(const std::filesystem::path& path, const ArtefactInfo& info,
                                const VerifyOptions& options) {
  const Study study = tested_study(path, info, options);
  const PolicyTest test = read_policy_test(path);
  const auto task = make_task(study);
  const RowMatrix theta = tested_parameters(study, *make_source(study));
  const Vector stored = stored_returns(test);
  const Index num_states = test.initial_states.rows();
  if (stored.size() != theta.rows() * num_states) {
    throw InputError(path.string() +
                     ": its returns aren't those of its grid; rerun stage "
                     "'policy_test'");
  }
  Verification result;
  result.num_rows = stored.size();
  for (const Index row : pick_rows(result.num_rows, options.count, options.pick)) {
    const sim::PolicyRollouts again =
        task->run(theta.row(row / num_states), test.initial_states.row(row % num_states),
                  test.policy.transpose());
    ++result.num_checked;
    const double value = again.returns(0);
    const bool are_nan = std::isnan(value) && std::isnan(stored(row));
    if (value != stored(row) && !are_nan) result.different.push_back(row);
  }
  return result;
}

bool is_simulation(const ArtefactInfo& info) {
  return info.schema.name == kSimulationSchema.name ||
         info.schema.name == kSimulationShardSchema.name;
}

// All that is read of the file. Anybody may have made it, and some crash HDF5: a child goes first.
void read_all(const std::filesystem::path& path, const VerifyOptions& options) {
  const ArtefactInfo info = read_artefact_info(path);
  if (is_simulation(info)) read_rows(path, info, options);
  if (info.schema.name == kProposalSchema.name) {
    open_artefact(path, kProposalSchema).read_matrix<double>("theta");
  }
  if (info.schema.name == kPolicyTestSchema.name) read_policy_test(path);
}

}  // namespace

Verification verify(const std::filesystem::path& given, const VerifyOptions& options) {
  // A link of the readable folder leads to the cache, where the inputs lie.
  const std::filesystem::path path = std::filesystem::weakly_canonical(given);
  if (!survives([&] { read_all(path, options); })) throw damaged_file(path);
  const ArtefactInfo info = read_artefact_info(path);
  if (is_simulation(info)) return verify_simulation(path, info, options);
  const std::string& schema = info.schema.name;
  if (schema == kProposalSchema.name) return verify_proposal(path, info, options);
  if (schema == kPolicyTestSchema.name) return verify_policy_test(path, info, options);
  throw InputError(path.string() + ": a " + schema +
                   "; only simulations, their shards, first proposals and tests of policies can be "
                   "verified");
}

}  // namespace npdr::pipeline
