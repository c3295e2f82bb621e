/// Metrics that simulations are measured by, against the target.
#pragma once

#include <span>
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

struct MetricTraits : EnumRow<Metric> {
  /// Makes a name for people, with its unit.
  std::string (*title)(const sim::SimulatorInfo& info);
};

/// Every metric, in the documented order.
std::span<const MetricTraits> enum_table(Metric);
const MetricTraits& traits_of(Metric metric);

}  // namespace npdr::pipeline
