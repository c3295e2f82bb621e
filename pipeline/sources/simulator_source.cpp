#include <functional>

#include "pipeline/artefacts/recording.h"
#include "pipeline/config/simulator_info.h"
#include "pipeline/sources/program_call.h"
#include "pipeline/sources/source.h"
#include "pipeline/store/hash.h"
#include "sim/library/library_simulator.h"

namespace npdr::pipeline {
namespace {

// Rows of a simulator in this process.
class ReplayedRows final : public RowSimulator {
 public:
  using Replay = std::function<sim::Trajectories(const RowMatrix& complete, const StreamId& first)>;
  explicit ReplayedRows(Replay replay) : replay_(std::move(replay)) {}

  sim::Trajectories simulate(const RowMatrix& complete, const StreamId& first) override {
    return replay_(complete, first);
  }

  // Bounds memory, and is a multiple of every batch.
  Index block_size(Index) const override { return 256; }

 private:
  Replay replay_;
};

class BuiltInSource final : public Source {
 public:
  using Source::Source;

  // Settings that mean nothing to a simulator change nothing in it. A simulated target is one
  // segment.
  SourceKeys keys() const override {
    SourceKeys keys;
    keys.rows = settings();
    const int version = sim::rollout_version(study().simulator.name);
    if (version > 1) keys.rows["version"] = version;
    keys.states = keys.rows;
    keys.states.erase("store_every");
    keys.truth = keys.states;
    keys.truth.erase("segment_length");
    keys.theta = nlohmann::ordered_json::object();
    if (study().target.inputs) keys.truth["begin"] = content_hash(begun_truth());
    return keys;
  }

  std::unique_ptr<RowSimulator> open(const RowsConfig& config) const override {
    return std::make_unique<ReplayedRows>(
        [simulator = std::shared_ptr<const sim::Simulator>(sim::make_simulator(config.simulator)),
         target = config.target](const RowMatrix& complete, const StreamId&) {
          return simulator->replay(target, complete);
        });
  }
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
    const sim::SimulatorConfig& settings = config.simulator;
    return std::make_unique<ReplayedRows>(
        [simulator = simulator_, segments = sim::cut(config.target, settings.segment_length),
         store_every = settings.store_every](const RowMatrix& complete, const StreamId& first) {
          std::vector<std::uint32_t> seeds;
          for (Index i = 0; i < complete.rows(); ++i) seeds.push_back(row_seed(first, i));
          return simulator->replay(segments, store_every, complete, seeds);
        });
  }

 private:
  std::shared_ptr<const sim::LibrarySimulator> simulator_;
};

}  // namespace

std::unique_ptr<Source> make_built_in_source(const Study& study) {
  return std::make_unique<BuiltInSource>(study);
}

std::unique_ptr<Source> make_library_source(const Study& study) {
  return std::make_unique<LibrarySource>(study);
}

}  // namespace npdr::pipeline
