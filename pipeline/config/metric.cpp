#include "pipeline/config/metric.h"

#include <fmt/format.h>

namespace npdr::pipeline {
namespace {

using sim::SimulatorInfo;

constexpr MetricTraits kMetrics[] = {
    {{Metric::dtw, "dtw"}, [](const SimulatorInfo&) -> std::string { return "DTW dist."; }},
    {{Metric::rmse, "rmse"}, [](const SimulatorInfo&) -> std::string { return "RMSE"; }},
    {{Metric::final_error, "final_error"},
     [](const SimulatorInfo& info) {
       return fmt::format("Final error [{}]", info.state_channels.front().unit);
     }},
    {{Metric::goal, "goal"},
     [](const SimulatorInfo& info) { return fmt::format("P({})", info.goal->description); }},
    {{Metric::distance, "distance"},
     [](const SimulatorInfo&) -> std::string { return "Distance to x_o [prior std]"; }},
};

}  // namespace

std::span<const MetricTraits> enum_table(Metric) { return kMetrics; }

const MetricTraits& traits_of(Metric metric) {
  return *std::ranges::find(kMetrics, metric, &MetricTraits::value);
}

}  // namespace npdr::pipeline
