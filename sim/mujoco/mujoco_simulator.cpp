#include "sim/mujoco/mujoco_simulator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace npdr::mujoco {
namespace {

[[noreturn]] void fail(const std::string& message) { throw std::runtime_error(message); }

// "pole [rad]" as its label and unit; no unit: "".
std::pair<std::string, std::string> label_and_unit(const std::string& text) {
  const std::size_t open = text.rfind(" [");
  if (open == std::string::npos || text.back() != ']') return {text, ""};
  return {text.substr(0, open), text.substr(open + 2, text.size() - open - 3)};
}

bool is_single(const mjModel* model, int joint) {
  return model->jnt_type[joint] == mjJNT_HINGE || model->jnt_type[joint] == mjJNT_SLIDE;
}

// Positions of all hinges and slides, then their velocities.
std::vector<std::string> names_of_motion(const mjModel* m) {
  std::vector<std::string> names;
  for (const char* suffix : {"", "_dot"}) {
    for (int j = 0; j < static_cast<int>(m->njnt); ++j) {
      if (!is_single(m, j)) continue;
      const char* const name = mj_id2name(m, mjOBJ_JOINT, j);
      if (name == nullptr || *name == '\0') {
        fail(
            fmt::format("joint {} has no name: give it one, so that a recording's channel can "
                        "have it",
                        j));
      }
      names.push_back(name + std::string(suffix));
    }
  }
  return names;
}

StateChannel joint_channel(StateChannel channel, int joint, const mjModel* m) {
  if (!is_single(m, joint)) {
    fail(fmt::format("joint '{}' is neither hinge nor slide", channel.label));
  }
  const bool is_position = channel.source == StateChannel::Source::position;
  channel.address = is_position ? m->jnt_qposadr[joint] : m->jnt_dofadr[joint];
  channel.first = channel.source;
  channel.first_address = channel.address;
  if (!channel.unit.empty()) return channel;
  channel.unit = m->jnt_type[joint] == mjJNT_HINGE ? "rad" : "m";
  if (!is_position) channel.unit += "/s";
  return channel;
}

StateChannel sensor_channel(StateChannel channel, int sensor, const mjModel* m) {
  if (m->sensor_dim[sensor] != 1) {
    fail(fmt::format("sensor '{}' gives {} numbers, must be one", channel.label,
                     m->sensor_dim[sensor]));
  }
  channel.source = StateChannel::Source::sensor;
  channel.address = m->sensor_adr[sensor];
  if (channel.unit.empty()) channel.unit = "1";
  const bool is_position = m->sensor_type[sensor] == mjSENS_JOINTPOS;
  if (!is_position && m->sensor_type[sensor] != mjSENS_JOINTVEL) return channel;
  const int joint = m->sensor_objid[sensor];
  channel.first = is_position ? StateChannel::Source::position : StateChannel::Source::velocity;
  channel.first_address = is_position ? m->jnt_qposadr[joint] : m->jnt_dofadr[joint];
  return channel;
}

// The channel that a study calls "pole [rad]".
StateChannel find_channel(const std::string& text, const mjModel* m) {
  constexpr std::string_view dot = "_dot";
  const auto [label, unit] = label_and_unit(text);
  StateChannel channel{label, unit};
  const int joint = mj_name2id(m, mjOBJ_JOINT, label.c_str());
  if (joint >= 0) return joint_channel(channel, joint, m);
  const int sensor = mj_name2id(m, mjOBJ_SENSOR, label.c_str());
  if (sensor >= 0) return sensor_channel(channel, sensor, m);
  if (label.ends_with(dot)) {
    const std::string of = label.substr(0, label.size() - dot.size());
    const int moving = mj_name2id(m, mjOBJ_JOINT, of.c_str());
    channel.source = StateChannel::Source::velocity;
    if (moving >= 0) return joint_channel(channel, moving, m);
  }
  fail(
      fmt::format("no state '{}': must be the name of a joint ({}), with _dot its velocity, or of "
                  "a sensor ({})",
                  label, names_of(m, mjOBJ_JOINT), names_of(m, mjOBJ_SENSOR)));
}

}  // namespace

MujocoSimulator::MujocoSimulator(const std::string& settings) {
  const nlohmann::json json = nlohmann::json::parse(settings);
  spec_ = parse(json.at("model").get<std::string>());
  nominal_ = compile(spec_.get());
  model_ = compile(spec_.get());
  data_.reset(mj_makeData(model_.get()));
  if (!data_) fail("MuJoCo can't make the model's data: out of memory?");
  fingerprint_ = fingerprint(nominal_.get());
  find_states(json.at("states").get<std::vector<std::string>>());
  describe_unrecorded();
  find_actions(json.at("actions").get<std::vector<std::string>>());
  const auto names = json.at("parameters").is_null()
                         ? parameter_names(nominal_.get())
                         : json.at("parameters").get<std::vector<std::string>>();
  for (const std::string& name : names) {
    parameters_.push_back(find_parameter(name, spec_.get(), nominal_.get()));
  }
  for (const MujocoParameter& p : parameters_) {
    described_parameters_.push_back(
        {p.name.c_str(), p.unit.c_str(), p.nominal, p.lower, p.upper, 0.0, p.description.c_str()});
  }
  for (const StateChannel& channel : states_) {
    described_states_.push_back({channel.label.c_str(), channel.unit.c_str()});
  }
  for (std::size_t i = 0; i < actuators_.size(); ++i) {
    described_actions_.push_back({action_labels_[i].c_str(), action_units_[i].c_str()});
  }
  delays_.assign(static_cast<std::size_t>(nominal_->nu), 0.0);
}

void MujocoSimulator::find_states(const std::vector<std::string>& names) {
  for (const std::string& text : names.empty() ? names_of_motion(nominal_.get()) : names) {
    states_.push_back(find_channel(text, nominal_.get()));
    reads_sensors_ = reads_sensors_ || states_.back().source == StateChannel::Source::sensor;
  }
  if (states_.empty()) fail("the model has no hinge or slide that moves");
  for (StateChannel& sensor : states_) {  // where a joint is a channel itself, that one counts
    if (sensor.source != StateChannel::Source::sensor) continue;
    const bool is_known = std::ranges::any_of(states_, [&](const StateChannel& joint) {
      return joint.source == sensor.first && joint.address == sensor.first_address;
    });
    if (is_known) sensor.first = StateChannel::Source::sensor;
  }
}

// For people: joints that no channel says the place of, where segments begin as the model does.
void MujocoSimulator::describe_unrecorded() {
  std::string joints;
  for (int j = 0; j < static_cast<int>(nominal_->njnt); ++j) {
    const bool is_recorded = std::ranges::any_of(states_, [&](const StateChannel& channel) {
      return channel.first == StateChannel::Source::position &&
             channel.first_address == nominal_->jnt_qposadr[j];
    });
    const char* const name = mj_id2name(nominal_.get(), mjOBJ_JOINT, j);
    if (!is_recorded) joints += (joints.empty() ? "" : ", ") + std::string(name ? name : "?");
  }
  text_ = "a model of MuJoCo";
  if (!joints.empty()) {
    text_ +=
        "; segments begin with the model's own position of joints that aren't recorded: " + joints;
  }
}

void MujocoSimulator::find_actions(const std::vector<std::string>& names) {
  const mjModel* const m = nominal_.get();
  std::vector<std::string> wanted = names;
  if (wanted.empty()) {
    for (int i = 0; i < static_cast<int>(m->nu); ++i) {
      const char* const name = mj_id2name(m, mjOBJ_ACTUATOR, i);
      wanted.push_back(name == nullptr ? "" : name);
    }
  }
  for (const std::string& text : wanted) {
    const auto [label, unit] = label_and_unit(text);
    const int id = mj_name2id(m, mjOBJ_ACTUATOR, label.c_str());
    if (id < 0) {
      fail(fmt::format("no action '{}': must be the name of an actuator ({})", label,
                       names_of(m, mjOBJ_ACTUATOR)));
    }
    actuators_.push_back(id);
    action_labels_.push_back(label);
    action_units_.push_back(unit.empty() ? "1" : unit);
  }
}

npdr_description MujocoSimulator::description() const {
  const char* const name = nominal_->names;  // the model's own comes first
  npdr_description d = {};
  d.name = *name == '\0' ? "MuJoCo model" : name;
  d.text = text_.c_str();
  d.num_parameters = static_cast<std::int64_t>(described_parameters_.size());
  d.parameters = described_parameters_.data();
  d.num_states = static_cast<std::int64_t>(described_states_.size());
  d.states = described_states_.data();
  d.num_actions = static_cast<std::int64_t>(described_actions_.size());
  d.actions = described_actions_.data();
  d.fingerprint = fingerprint_.c_str();
  return d;
}

// Makes the model that of the parameters; false when they are impossible together.
bool MujocoSimulator::apply(const double* theta) {
  bool compiles = false, changes_constants = false;
  for (std::size_t p = 0; p < parameters_.size(); ++p) {
    if (parameters_[p].in_spec == nullptr) continue;
    *parameters_[p].in_spec = theta[p];
    compiles = true;
  }
  if (compiles) {
    model_ = try_compile(spec_.get());
    if (!model_) {  // the next row needs one that is complete
      model_ = Model(mj_copyModel(nullptr, nominal_.get()));
      return false;
    }
  } else {  // writers scale masses
    std::copy_n(nominal_->body_mass, nominal_->nbody, model_->body_mass);
    std::copy_n(nominal_->body_inertia, 3 * nominal_->nbody, model_->body_inertia);
  }
  model_->opt.timestep = nominal_->opt.timestep;
  for (std::size_t p = 0; p < parameters_.size(); ++p) {
    const MujocoParameter& parameter = parameters_[p];
    if (parameter.write) parameter.write(model_.get(), theta[p]);
    if (parameter.delayed_actuator >= 0) {
      delays_[static_cast<std::size_t>(parameter.delayed_actuator)] = theta[p];
    }
    changes_constants = changes_constants || parameter.changes_constants;
  }
  if (!changes_constants) return true;
  const auto set_constants = [](void* self) {
    const auto& s = *static_cast<MujocoSimulator*>(self);
    mj_setConst(s.model_.get(), s.data_.get());
  };
  return without_errors(set_constants, this);
}

struct MujocoSimulator::Run {
  MujocoSimulator& simulator;
  const npdr_batch& batch;
  const double* theta;
  double* states;
  std::uint8_t status;
};

void MujocoSimulator::replay(const npdr_batch& batch, double* states, std::uint8_t* status) {
  const double timestep = nominal_->opt.timestep;
  const double substeps = batch.dt / timestep;
  const bool has_own_step = std::ranges::any_of(
      parameters_, [](const MujocoParameter& p) { return p.name == "option.timestep"; });
  if (!has_own_step && std::abs(substeps - std::round(substeps)) > 1e-6 * substeps) {
    fail(
        fmt::format("the recording's step of {} s isn't a multiple of the model's timestep of {} s",
                    batch.dt, timestep));
  }
  const auto row_size = batch.num_steps * static_cast<std::int64_t>(states_.size());
  const auto num_parameters = static_cast<std::int64_t>(parameters_.size());
  for (std::int64_t i = 0; i < batch.num_rows; ++i) {
    const double* const theta = batch.theta + i * num_parameters;
    if (!apply(theta)) {
      status[i] = NPDR_OUT_OF_LIMITS;
      continue;
    }
    Run run{*this, batch, theta, states + i * row_size, NPDR_OK};
    const auto go = [](void* argument) {
      Run& r = *static_cast<Run*>(argument);
      r.status = r.simulator.run(r.batch, r.states) ? NPDR_OK : NPDR_DIVERGED;
    };
    if (!without_errors(go, &run)) run.status = NPDR_DIVERGED;
    status[i] = run.status;
  }
}

// False when MuJoCo found a state that isn't finite, which it resets without a word.
bool MujocoSimulator::run(const npdr_batch& batch, double* states) {
  std::int64_t begin = 0;
  for (std::int64_t s = 0; s < batch.num_segments; ++s) {
    run_segment(batch, s, begin, states + begin * static_cast<std::int64_t>(states_.size()));
    for (const mjtWarning bad : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC, mjWARN_BADCTRL}) {
      if (data_->warning[bad].number > 0) return false;
    }
    begin += batch.steps[s];
  }
  return true;
}

void MujocoSimulator::run_segment(const npdr_batch& batch, std::int64_t segment, std::int64_t begin,
                                  double* states) {
  mjModel* const m = model_.get();
  mjData* const d = data_.get();
  const auto channels = static_cast<std::int64_t>(states_.size());
  mj_resetData(m, d);
  const double* const first = batch.first_states + segment * channels;
  for (std::int64_t c = 0; c < channels; ++c) {
    const StateChannel& channel = states_[static_cast<std::size_t>(c)];
    if (channel.first == StateChannel::Source::position) d->qpos[channel.first_address] = first[c];
    if (channel.first == StateChannel::Source::velocity) d->qvel[channel.first_address] = first[c];
  }
  const int substeps = std::max(1, static_cast<int>(std::round(batch.dt / m->opt.timestep)));
  m->opt.timestep = batch.dt / substeps;
  for (std::int64_t t = 0; t < batch.steps[segment]; ++t) {
    for (int k = 0; k < substeps; ++k) {
      set_controls(batch, begin + t, batch.past[segment] + t, k, substeps);
      mj_step(m, d);
    }
    if (reads_sensors_) mj_forward(m, d);
    read_state(states + t * channels);
  }
}

// Controls of a substep of a step, before which its rollout has `past` steps: those of so much
// earlier. The first ones of the rollout stand for all before it.
void MujocoSimulator::set_controls(const npdr_batch& batch, std::int64_t step, std::int64_t past,
                                   int substep, int num_substeps) {
  const auto num_actions = static_cast<std::int64_t>(actuators_.size());
  for (std::int64_t a = 0; a < num_actions; ++a) {
    const int actuator = actuators_[static_cast<std::size_t>(a)];
    const double delay = delays_[static_cast<std::size_t>(actuator)];
    std::int64_t late = 0;
    if (delay > 0.0) {
      // The middle of the substep counts, so that rounding can't move it to another step.
      const double when = (substep + 0.5) / num_substeps - delay;
      late = -static_cast<std::int64_t>(std::floor(when));
    }
    data_->ctrl[actuator] = batch.actions[(step - std::min(late, past)) * num_actions + a];
  }
}

void MujocoSimulator::read_state(double* state) const {
  for (std::size_t c = 0; c < states_.size(); ++c) {
    const StateChannel& channel = states_[c];
    const mjtNum* const from = channel.source == StateChannel::Source::position ? data_->qpos
                               : channel.source == StateChannel::Source::velocity
                                   ? data_->qvel
                                   : data_->sensordata;
    state[c] = from[channel.address];
  }
}

}  // namespace npdr::mujoco
