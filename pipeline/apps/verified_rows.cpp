#include "pipeline/apps/verified_rows.h"

#include <algorithm>

#include "core/random.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/simulation_file.h"

namespace npdr::pipeline {
namespace {

ArtefactFile proposal_of(const std::filesystem::path& path, const ArtefactInfo& info) {
  const std::filesystem::path cache = simulation_of(path, info).parent_path().parent_path();
  const std::string key = info.identity.inputs.at("proposal");
  return {cache / "propose" / (key + ".h5"), key};
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
      begin_(info.identity.key_document.value("begin", Index{0})) {}

}  // namespace npdr::pipeline
