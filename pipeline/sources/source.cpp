#include "pipeline/sources/source.h"

#include <fmt/format.h>

#include "core/error.h"
#include "core/feature_names.h"
#include "pipeline/artefacts/feature_file.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/config/simulator_info.h"
#include "pipeline/config/study_check.h"
#include "pipeline/config/study_json.h"
#include "pipeline/sources/dataset_rows.h"
#include "pipeline/sources/source_kinds.h"
#include "pipeline/sources/truth_inputs.h"

namespace npdr::pipeline {

Source::Source(Study study)
    : study_(std::move(study)), info_(simulator_info(study_)), parameters_(study_, info_) {}

Target Source::behave(const std::filesystem::path& log) const {
  const TargetConfig& target = study_.target;
  Target all;
  if (traits().is_built_in && !target.inputs) {
    all = sim::make_simulator(study_.simulator)
              ->behave(parameters_.nominal(*target.truth), target.num_rollouts + target.held_out,
                       target.seed);
  } else if (traits().gives_motion) {
    all = replay_truth(begun_truth(study_, info_), log);
  } else {
    const Vector unknown = Vector::Zero(std::ssize(info_.state_channels));
    all = replay_truth(observation_target(info_.state_channels, unknown, "simulated at the truth"),
                       log);
  }
  for (Index h = 0; h < all.num_rollouts(); ++h) {
    all.rollouts[static_cast<std::size_t>(h)].number = h;
  }
  return all;
}

Target Source::replay_truth(Target begun, const std::filesystem::path& log) const {
  sim::SimulatorConfig config = study_.simulator;
  config.store_every = 1;
  config.segment_length = 0;
  const auto rows = open({.simulator = config, .target = begun, .log = log});
  const TargetConfig& target = study_.target;
  const sim::Trajectories x = rows->simulate(parameters_.nominal(*target.truth).transpose(),
                                             {target.seed, kTruthStream, 0, 0, 0});
  if (x.status.front() != sim::RolloutStatus::ok) {
    const std::string why = rows->last_failure();
    throw Error(
        fmt::format("target.truth: the simulation there ends as {}{}; choose a truth that can be "
                    "simulated",
                    sim::to_string(x.status.front()), why.empty() ? "" : ": " + why));
  }
  for (Index h = 0; h < begun.num_rollouts(); ++h) {
    begun.rollouts[static_cast<std::size_t>(h)].states.bottomRows(begun.num_steps()) =
        x.rollout(0, h).cast<double>();
  }
  return begun;
}

nlohmann::ordered_json Source::settings() const {
  return key_json(SimulatorTable{study_.simulator, study_.external});
}

nlohmann::ordered_json Source::own_settings() const {
  nlohmann::ordered_json own = settings();
  for (const char* key : {"parameters", "segment_length", "store_every"}) own.erase(key);
  return own;
}

SourceKeys Source::keys_of_motion(const nlohmann::ordered_json& rows) const {
  SourceKeys keys{rows, rows, rows, nlohmann::ordered_json::object()};
  keys.rows["segment_length"] = study_.simulator.segment_length;
  keys.states["segment_length"] = study_.simulator.segment_length;
  keys.rows["store_every"] = study_.simulator.store_every;
  if (study_.target.truth) keys.truth["begin"] = content_hash(begun_truth(study_, info_));
  return keys;
}

std::unique_ptr<Source> make_source(const Study& study) {
  switch (study.source().kind) {
    case SourceKind::command:
    case SourceKind::motion_command:
    case SourceKind::worker:
      return make_program_source(study);
    case SourceKind::library:
    case SourceKind::mjcf:
      return make_library_source(study);
    case SourceKind::dataset:
      return make_dataset_source(study);
    case SourceKind::built_in:
      break;
  }
  return make_built_in_source(study);
}

std::optional<Target> resolve_source(Study& study) {
  if (study.source().gives_motion) {
    if (study.target.inputs && study.target.num_rollouts == 0) {
      study.target.num_rollouts = read_recording(*study.target.inputs).num_rollouts();
    }
    return std::nullopt;
  }
  std::vector<Channel> features = parse_features(study.external.features);
  if (study.external.dataset) {
    const DatasetFile dataset = open_dataset(study);
    features = dataset.features();
    check_dataset_rows(study, dataset.num_rows());
    take_units(study, dataset.parameters());
  }
  std::optional<Target> x_o;
  if (study.target.observation) {
    x_o = read_observation(*study.target.observation, features);
    const bool has_names = x_o->state_channels != numbered_features(x_o->num_states());
    if (features.empty()) {
      study.external.names_from = has_names ? NamesFrom::observation : NamesFrom::nobody;
    }
    features = x_o->state_channels;
    check_recording(study, *x_o);
  }
  study.external.features = feature_names(features);
  return x_o;
}

}  // namespace npdr::pipeline
