#include "pipeline/config/cluster_check.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "core/text.h"
#include "pipeline/config/checker.h"
#include "pipeline/config/constraint.h"

namespace npdr::pipeline {
namespace {

std::vector<double> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string& part : split(text, ':')) numbers.push_back(std::stod(part));
  return numbers;
}

}  // namespace

std::optional<double> seconds_of(const std::string& time) {
  if (time.empty()) return std::nullopt;
  const std::size_t dash = time.find('-');
  if (dash != std::string::npos) {
    std::vector<double> clock = numbers_of(time.substr(dash + 1));
    clock.resize(3, 0.0);
    return ((std::stod(time.substr(0, dash)) * 24.0 + clock[0]) * 60.0 + clock[1]) * 60.0 +
           clock[2];
  }
  const std::vector<double> clock = numbers_of(time);
  if (clock.size() == 1) return clock[0] * 60.0;
  if (clock.size() == 2) return clock[0] * 60.0 + clock[1];
  return (clock[0] * 60.0 + clock[1]) * 60.0 + clock[2];
}

void check_cluster(const Study& study, Reading& reading) {
  const ClusterConfig& cluster = study.cluster;
  const std::vector<std::pair<const char*, const std::string*>> times = {
      {"time", &cluster.time},
      {"prepare.time", &cluster.prepare.time},
      {"simulate.time", &cluster.simulate.time},
      {"infer.time", &cluster.infer.time},
      {"baseline.time", &cluster.baseline.time},
      {"evaluate.time", &cluster.evaluate.time},
      {"diagnose.time", &cluster.diagnose.time},
      {"policy.time", &cluster.policy.time},
      {"report.time", &cluster.report.time}};
  for (const auto& [key, time] : times) {
    const std::string path = std::string("cluster.") + key;
    if (!reading.good(path) || !reading.good("cluster.signal_seconds")) continue;
    const std::optional<double> seconds = seconds_of(*time);
    if (!seconds || *seconds > static_cast<double>(cluster.signal_seconds)) continue;
    Checker(reading).fail(
        path, quoted(*time),
        fmt::format("longer than cluster.signal_seconds = {}", cluster.signal_seconds));
  }
}

}  // namespace npdr::pipeline
