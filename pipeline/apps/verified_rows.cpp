#include "pipeline/apps/verified_rows.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/random.h"
#include "core/text.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/simulation_file.h"

namespace npdr::pipeline {
namespace {

ArtefactFile proposal_of(const std::filesystem::path& path, const ArtefactInfo& info) {
  const std::string key = input_key(path, info, "proposal");
  return {WorkFolder::beside(simulation_of(path, info), "propose", key), key};
}

}  // namespace

PickedRows::PickedRows(Index num_rows, const VerifyOptions& options)
    : size_(std::min(options.count, num_rows)) {
  if (size_ == num_rows) return;  // nothing to pick, however many there are
  Stream stream({options.pick, "verify", 0, 0, 0});
  const auto order = stream.permutation(static_cast<std::uint32_t>(num_rows));
  some_.assign(order.begin(), order.begin() + size_);
  std::sort(some_.begin(), some_.end());
}

std::string input_key(const std::filesystem::path& path, const ArtefactInfo& info,
                      const std::string& name) {
  const auto found = info.identity.inputs.find(name);
  if (found == info.identity.inputs.end()) {
    throw InputError(path.string() + ": names no input '" + name +
                     "': no stage made it; rerun stage '" + info.schema.stage + "'");
  }
  return found->second;
}

Index count_of(const std::filesystem::path& path, const nlohmann::ordered_json& document,
               const std::string& name, std::optional<Index> otherwise) {
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

std::filesystem::path simulation_of(const std::filesystem::path& path, const ArtefactInfo& info) {
  if (info.schema.name != kSimulationShardSchema.name) return path;
  return path.parent_path().string() + ".h5";
}

StoredRows::StoredRows(const std::filesystem::path& path, const ArtefactInfo& info)
    : file_(open_artefact(path, info.schema.name == kSimulationShardSchema.name
                                    ? kSimulationShardSchema
                                    : kSimulationSchema)),
      values_(simulated_values(file_)),
      theta_(file_.dataset("theta")),
      status_(file_.dataset("status")) {
  theta_.require_shape({values_.num_rows(), -1});
  status_.require_shape({values_.num_rows()});
}

ProposedRows::ProposedRows(const std::filesystem::path& path, const ArtefactInfo& info)
    : theta_(open_proposal(proposal_of(path, info))),
      begin_(count_of(path, info.identity.key_document, "begin", 0)) {}

}  // namespace npdr::pipeline
