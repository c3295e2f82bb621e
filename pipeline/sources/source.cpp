#include "pipeline/sources/source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/feature_names.h"
#include "core/text.h"
#include "pipeline/artefacts/feature_file.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/config/simulator_info.h"
#include "pipeline/config/study_check.h"
#include "pipeline/config/study_json.h"

namespace npdr::pipeline {

ParameterMap::ParameterMap(const Study& study, const sim::SimulatorInfo& info)
    : info_(info), nominal_values_(study.simulator.parameters) {
  for (const inference::Marginal& marginal : study.prior) {
    columns_.push_back(sim::parameter_index(info_, marginal.name));
  }
}

Vector ParameterMap::nominal(const std::map<std::string, double>& values) const {
  std::map<std::string, double> all = values;
  all.insert(nominal_values_.begin(), nominal_values_.end());
  return sim::complete_theta(info_, all);
}

RowMatrix ParameterMap::complete(const RowMatrix& theta) const {
  RowMatrix all = nominal().transpose().replicate(theta.rows(), 1);
  all(Eigen::all, columns_) = theta;
  return all;
}

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
    all = replay_truth(begun_truth(), log);
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

Target Source::resting_truth() const {
  Target target;
  target.dt = info_.dt;
  target.state_channels = info_.state_channels;
  target.action_channels = info_.action_channels;
  target.source = "simulated by '" + info_.name + "'";
  const auto& states = study_.external.initial_states;
  const Index count = study_.target.num_rollouts + study_.target.held_out;
  for (Index h = 0; h < count; ++h) {
    const std::vector<double> first = states.empty()
                                          ? std::vector<double>()
                                          : states[static_cast<std::size_t>(h) % states.size()];
    if (std::ssize(first) != target.num_states()) {
      throw InputError(
          fmt::format("simulator.initial_states has a list of {}, must have {}: the "
                      "state channels of '{}'",
                      counted(std::ssize(first), "number"), target.num_states(), info_.name));
    }
    Rollout rollout{std::to_string(h), RowMatrix::Zero(info_.num_steps + 1, target.num_states()),
                    RowMatrix::Zero(info_.num_steps, target.num_actions())};
    rollout.states.row(0) = Eigen::Map<const Eigen::RowVectorXd>(first.data(), std::ssize(first));
    target.rollouts.push_back(std::move(rollout));
  }
  return target;
}

Target Source::begun_truth() const {
  const TargetConfig& config = study_.target;
  Target target =
      config.inputs ? read_recording(*config.inputs, channels_of(info_)) : resting_truth();
  if (config.inputs) {
    check_recording(study_, target);
    if (config.num_rollouts > 0) target = target.first(config.num_rollouts + config.held_out);
    target.source = "simulated over the actions of " + *config.inputs;
  }
  for (Rollout& rollout : target.rollouts) rollout.states.bottomRows(rollout.num_steps()).setZero();
  return target;
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
  if (study_.target.truth) keys.truth["begin"] = content_hash(begun_truth());
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

sim::Segments feature_segments(Index num_features) {
  return {.dt = 1.0,
          .num_rollouts = 1,
          .steps = {1},
          .past = {0},
          .first_states = RowMatrix::Zero(1, num_features),
          .actions = RowMatrix(1, 0)};
}

std::string find_lost_number(std::span<const double> row, const std::vector<Channel>& channels,
                             Index num_steps) {
  constexpr double largest = std::numeric_limits<float>::max();
  const auto lost =
      std::ranges::find_if(row, [](double value) { return !(std::abs(value) <= largest); });
  if (lost == row.end()) return "";
  const Index place = lost - row.begin(), count = std::ssize(channels);
  const std::string& label = channels[static_cast<std::size_t>(place % count)].label;
  const std::string found = fmt::format("{:.3g} in '{}'", *lost, label);
  if (num_steps == 1) return found;
  const Index step = place / count;
  return fmt::format("{}, step {} of rollout {}", found, step % num_steps + 1,
                     step / num_steps + 1);
}

std::uint32_t row_seed(const StreamId& first, Index i) {
  return Stream(row_after(first, i)).bits() >> 1;
}

std::filesystem::path log_of(const std::filesystem::path& artefact) {
  return std::filesystem::path(artefact).replace_extension(".log");
}

}  // namespace npdr::pipeline
