#include "pipeline/config/metric.h"

#include <fmt/format.h>

namespace npdr::pipeline {

std::string title_of(Metric metric, const sim::SimulatorInfo& info) {
  using enum Metric;
  if (metric == dtw) return "DTW dist.";
  if (metric == rmse) return "RMSE";
  if (metric == goal) return fmt::format("P({})", info.goal->description);
  if (metric == distance) return "Distance to x_o [prior std]";
  return fmt::format("Final error [{}]", info.state_channels.front().unit);
}

}  // namespace npdr::pipeline
