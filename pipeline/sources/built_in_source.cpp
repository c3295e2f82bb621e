#include "pipeline/artefacts/recording.h"
#include "pipeline/config/study_json.h"
#include "pipeline/sources/source_kinds.h"
#include "pipeline/sources/truth_inputs.h"

namespace npdr::pipeline {
namespace {

using Json = nlohmann::ordered_json;

class ReplayedRows final : public RowSimulator {
 public:
  ReplayedRows(const sim::SimulatorConfig& config, Target target)
      : simulator_(sim::make_simulator(config)), target_(std::move(target)) {}

  sim::Trajectories simulate(const RowMatrix& complete, const StreamId&) override {
    return simulator_->replay(target_, complete);
  }

  // Bounds memory, and is a multiple of every batch.
  Index block_size(Index) const override { return 256; }

 private:
  std::unique_ptr<sim::Simulator> simulator_;
  Target target_;
};

Json without(Json json, const std::string& setting) {
  json.erase(setting);
  return json;
}

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
    keys.states = without(keys.rows, "store_every");
    keys.truth = without(keys.states, "segment_length");
    keys.theta = Json::object();
    if (study().target.inputs) keys.truth["begin"] = content_hash(begun_truth(study(), info()));
    return keys;
  }

  std::unique_ptr<RowSimulator> open(const RowsConfig& config) const override {
    return std::make_unique<ReplayedRows>(config.simulator, config.target);
  }
};

}  // namespace

std::unique_ptr<Source> make_built_in_source(const Study& study) {
  return std::make_unique<BuiltInSource>(study);
}

}  // namespace npdr::pipeline
