/// Metrics that simulations are measured by, against the target.
#pragma once

#include <string>

#include "core/enum_names.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// All but the last are of rollouts (analysis/metrics.h).
enum class Metric {
  dtw,
  rmse,
  final_error,  ///< for states of one unit
  goal,         ///< for a simulator that has one
  distance,     ///< of features, where the simulator gives no rollouts
};
constexpr auto enum_table(Metric) {
  using enum Metric;
  return std::to_array<EnumRow<Metric>>({{dtw, "dtw"},
                                         {rmse, "rmse"},
                                         {final_error, "final_error"},
                                         {goal, "goal"},
                                         {distance, "distance"}});
}

/// Name for people, with its unit.
std::string title_of(Metric metric, const sim::SimulatorInfo& info);

}  // namespace npdr::pipeline
