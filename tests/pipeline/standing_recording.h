/// Recordings of a pendulum that stands still.
#pragma once

#include <array>
#include <filesystem>

#include "pipeline/artefacts/recording.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// Writes up to three rollouts, of states `state`, `state` + 0.1, ...
inline void write_standing(const std::filesystem::path& path, std::size_t num_rollouts = 2,
                           Index num_steps = 40, double state = 1.0) {
  const sim::SimulatorInfo info = sim::make_simulator({.name = "pendulum"})->info();
  Target target{0.02, info.state_channels, info.action_channels, {}, "test"};
  constexpr std::array names = {"first", "second", "third"};
  for (std::size_t h = 0; h < num_rollouts; ++h) {
    const double value = state + 0.1 * static_cast<double>(h);
    target.rollouts.push_back(
        {names.at(h), RowMatrix::Constant(num_steps + 1, 2, value), RowMatrix::Zero(num_steps, 1)});
  }
  write_recording(target, path);
}

}  // namespace npdr::pipeline
