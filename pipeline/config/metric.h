/// Metrics that simulations are measured by, against the target.
#pragma once

#include <fmt/format.h>

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
constexpr auto enum_table(Metric) {
  using enum Metric;
  using Info = sim::SimulatorInfo;
  return std::to_array<MetricTraits>({
      {{dtw, "dtw"}, [](const Info&) -> std::string { return "DTW dist."; }},
      {{rmse, "rmse"}, [](const Info&) -> std::string { return "RMSE"; }},
      {{final_error, "final_error"},
       [](const Info& i) {
         return fmt::format("Final error [{}]", i.state_channels.front().unit);
       }},
      {{goal, "goal"}, [](const Info& i) { return fmt::format("P({})", i.goal->description); }},
      {{distance, "distance"},
       [](const Info&) -> std::string { return "Distance to x_o [prior std]"; }},
  });
}

inline MetricTraits traits_of(Metric metric) {
  const auto all = enum_table(metric);
  return *std::ranges::find(all, metric, &MetricTraits::value);
}

}  // namespace npdr::pipeline
