#include "pipeline/sources/truth_inputs.h"

#include <fmt/format.h>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/config/study_check.h"

namespace npdr::pipeline {
namespace {

Target recorded_inputs(const Study& study, const sim::SimulatorInfo& info) {
  Target target = read_recording(*study.target.inputs, channels_of(info));
  check_recording(study, target);
  if (study.target.num_rollouts > 0) {
    target = target.first(study.target.num_rollouts + study.target.held_out);
  }
  target.source = "simulated over the actions of " + *study.target.inputs;
  return target;
}

Target resting_inputs(const Study& study, const sim::SimulatorInfo& info) {
  Target target;
  target.dt = info.dt;
  target.state_channels = info.state_channels;
  target.action_channels = info.action_channels;
  target.source = "simulated by '" + info.name + "'";
  const auto& states = study.external.initial_states;
  const Index count = study.target.num_rollouts + study.target.held_out;
  for (Index h = 0; h < count; ++h) {
    const std::vector<double> first = states.empty()
                                          ? std::vector<double>()
                                          : states[static_cast<std::size_t>(h) % states.size()];
    if (std::ssize(first) != target.num_states()) {
      throw InputError(
          fmt::format("simulator.initial_states has a list of {}, must have {}: the "
                      "state channels of '{}'",
                      counted(std::ssize(first), "number"), target.num_states(), info.name));
    }
    Rollout rollout{std::to_string(h), RowMatrix::Zero(info.num_steps + 1, target.num_states()),
                    RowMatrix::Zero(info.num_steps, target.num_actions())};
    rollout.states.row(0) = Eigen::Map<const Eigen::RowVectorXd>(first.data(), std::ssize(first));
    target.rollouts.push_back(std::move(rollout));
  }
  return target;
}

}  // namespace

Target begun_truth(const Study& study, const sim::SimulatorInfo& info) {
  Target target = study.target.inputs ? recorded_inputs(study, info) : resting_inputs(study, info);
  for (Rollout& rollout : target.rollouts) rollout.states.bottomRows(rollout.num_steps()).setZero();
  return target;
}

}  // namespace npdr::pipeline
