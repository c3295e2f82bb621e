#include <memory>

#include "pipeline/config/simulator_info.h"
#include "pipeline/sources/file_hashes.h"
#include "pipeline/sources/source_kinds.h"
#include "pipeline/store/hash.h"
#include "sim/library/library_simulator.h"

namespace npdr::pipeline {
namespace {

class LibraryRows final : public RowSimulator {
 public:
  LibraryRows(std::shared_ptr<const sim::LibrarySimulator> simulator, const RowsConfig& config)
      : simulator_(std::move(simulator)),
        segments_(sim::cut(config.target, config.simulator.segment_length)),
        store_every_(config.simulator.store_every) {}

  sim::Trajectories simulate(const RowMatrix& complete, const StreamId& first) override {
    std::vector<std::uint32_t> seeds;
    for (Index i = 0; i < complete.rows(); ++i) seeds.push_back(row_seed(first, i));
    return simulator_->replay(segments_, store_every_, complete, seeds);
  }

  // Bounds memory.
  Index block_size(Index) const override { return 256; }

 private:
  std::shared_ptr<const sim::LibrarySimulator> simulator_;
  sim::Segments segments_;
  Index store_every_;
};

class LibrarySource final : public Source {
 public:
  explicit LibrarySource(const Study& study)
      : Source(study), simulator_(std::make_shared<sim::LibrarySimulator>(library_config(study))) {}

  SourceKeys keys() const override {
    const ExternalConfig& external = study().external;
    nlohmann::ordered_json json;
    if (external.library) {
      json["library"] = file_hash(*external.library);
    } else {
      json["mjcf"] = {{"states", external.states}, {"actions", external.actions}};
    }
    json.update(own_settings());
    Hasher fingerprint;
    fingerprint.add(simulator_->fingerprint());
    json["fingerprint"] = fingerprint.hex();
    if (!external.files.empty()) {
      json["further_files"] = FileHashes(external.files, external.folder).by_name();
    }
    json["parameters"] = study().simulator.parameters;
    return keys_of_motion(json);
  }

  std::unique_ptr<RowSimulator> open(const RowsConfig& config) const override {
    return std::make_unique<LibraryRows>(simulator_, config);
  }

 private:
  std::shared_ptr<const sim::LibrarySimulator> simulator_;
};

}  // namespace

std::unique_ptr<Source> make_library_source(const Study& study) {
  return std::make_unique<LibrarySource>(study);
}

}  // namespace npdr::pipeline
