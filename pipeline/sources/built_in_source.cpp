#include "pipeline/sources/built_in_source.h"

#include "pipeline/artefacts/recording.h"
#include "pipeline/config/study_json.h"
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

}  // namespace

// Settings that mean nothing to a simulator change nothing in it. A simulated target is one
// segment.
SourceKeys BuiltInSource::keys() const {
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

std::unique_ptr<RowSimulator> BuiltInSource::open(const RowsConfig& config) const {
  return std::make_unique<ReplayedRows>(config.simulator, config.target);
}

Target BuiltInSource::behave_by_itself() const {
  const TargetConfig& target = study().target;
  return sim::make_simulator(study().simulator)
      ->behave(parameters().nominal(*target.truth), target.num_rollouts + target.held_out,
               target.seed);
}

}  // namespace npdr::pipeline
