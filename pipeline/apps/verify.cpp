#include "pipeline/apps/verify.h"

#include <algorithm>
#include <bit>

#include "core/error.h"
#include "core/random.h"
#include "inference/prior.h"
#include "pipeline/config/study_json.h"
#include "pipeline/plan/schemas.h"
#include "pipeline/store/recording.h"
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

Verification verify_simulation(const std::filesystem::path& path, const ArtefactInfo& info,
                               Index count, std::uint64_t pick) {
  const bool is_shard = info.schema.name == kSimulationShardSchema.name;
  const h5::File file = open_artefact(path, is_shard ? kSimulationShardSchema : kSimulationSchema);
  const h5::Dataset trajectories = file.dataset("trajectories");
  trajectories.require_shape({-1, -1, -1, -1});
  const auto labels = file.dataset("theta").attribute<std::vector<std::string>>("labels");
  const RowMatrix theta =
      file.read_matrix<double>("theta", trajectories.num_rows(), static_cast<Index>(labels.size()));
  const auto config = from_json<sim::SimulatorConfig>(info.identity.study.at("simulator"),
                                                      path.string() + ": study.simulator");
  const auto simulator = sim::make_simulator(config);
  // A shard's own document doesn't hold the number of rollouts; its trajectories do.
  const Target target = target_of(simulation_of(path, info), info).first(trajectories.shape()[1]);

  Verification result;
  result.num_rows = trajectories.num_rows();
  std::vector<float> stored(static_cast<std::size_t>(trajectories.row_size()));
  for (const Index row : pick_rows(result.num_rows, count, pick)) {
    RowMatrix all = sim::complete_theta(*simulator, config.parameters).transpose();
    for (std::size_t d = 0; d < labels.size(); ++d) {
      all(0, sim::parameter_index(simulator->info(), labels[d])) =
          theta(row, static_cast<Index>(d));
    }
    const sim::Trajectories again = simulator->replay(target, all);
    trajectories.read_rows<float>(row, 1, stored);
    ++result.num_checked;
    if (!same(again.values, stored)) result.different.push_back(row);
  }
  return result;
}

Verification verify_proposal(const std::filesystem::path& path, const ArtefactInfo& info,
                             Index count, std::uint64_t pick) {
  const h5::File file = open_artefact(path, kProposalSchema);
  const auto& document = info.identity.key_document;
  if (!document.contains("prior")) {
    throw InputError(path.string() +
                     ": its rows come from a posterior; only those of the prior can be recomputed");
  }
  const inference::Prior prior(prior_from_json(document.at("prior"), path.string()));
  const RowMatrix theta = file.read_matrix<double>("theta", -1, prior.dimension());
  Verification result;
  result.num_rows = theta.rows();
  const auto round = document.value("round", std::uint64_t{1});
  for (const Index row : pick_rows(result.num_rows, count, pick)) {
    Stream stream({info.identity.seed, "prior", round, static_cast<std::uint64_t>(row), 0});
    ++result.num_checked;
    if (prior.sample(stream).transpose() != theta.row(row)) result.different.push_back(row);
  }
  return result;
}

}  // namespace

Verification verify(const std::filesystem::path& given, Index count, std::uint64_t pick) {
  // A link of the readable folder leads to the cache, where the inputs lie.
  const std::filesystem::path path = std::filesystem::weakly_canonical(given);
  const ArtefactInfo info = read_artefact_info(path);
  const std::string& schema = info.schema.name;
  if (schema == kSimulationSchema.name || schema == kSimulationShardSchema.name) {
    return verify_simulation(path, info, count, pick);
  }
  if (schema == kProposalSchema.name) return verify_proposal(path, info, count, pick);
  throw InputError(path.string() + ": a " + schema +
                   "; only simulations, their shards and first proposals can be verified");
}

}  // namespace npdr::pipeline
