#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "pipeline/config/checker.h"
#include "pipeline/config/part_checks.h"

namespace npdr::pipeline {
namespace {

class NoiseChecker : Checker {
 public:
  NoiseChecker(const Study& study, const sim::SimulatorInfo* info, Reading& reading)
      : Checker(reading), study_(study), info_(info) {}

  void check() {
    const ObservationNoise& noise = study_.observation_noise;
    must_be_left_out(unused_fields(fields_of(noise), "observation_noise"));
    if (!noise.is_silent() && !study_.source().gives_motion) check_features();
    if (noise.std) check_channels(*noise.std);
  }

 private:
  void check_features() {
    for (const char* key : {"correlation", "correlation_prior"}) {
      must_be_left_out(std::string("observation_noise.") + key,
                       "the simulator gives features, which have no neighbors in time");
    }
  }

  // The likelihood of a refinement is that of every channel's noise.
  void require_all(const std::map<std::string, double>& deviations,
                   const std::vector<std::string>& labels) {
    const ObservationNoise& noise = study_.observation_noise;
    if (std::ranges::none_of(study_.methods, [](const MethodConfig& method) {
          return method.algorithm.kind == inference::Algorithm::refine;
        })) {
      return;
    }
    const std::string needed = "algorithm 'refine' needs noise in each channel";
    for (const auto& [label, deviation] : deviations) {
      if (deviation == 0.0) fail("observation_noise.std." + label, "0", "> 0: " + needed);
    }
    if (noise.scale > 0.0 || noise.scale_prior) return;
    std::vector<std::string> missing = labels;
    std::erase_if(missing, [&](const std::string& label) { return deviations.contains(label); });
    if (missing.empty()) return;
    fail("observation_noise.std", "without " + join(missing),
         "of all channels, or beside a scale or scale_prior of the others: " + needed);
  }

  void check_channels(const std::map<std::string, double>& deviations) {
    const auto labels = info_ ? labels_of(info_->state_channels) : std::vector<std::string>();
    for (const auto& [label, deviation] : deviations) {
      const std::string key = "observation_noise.std." + label;
      require(key, deviation, deviation >= 0.0, ">= 0");
      if (labels.empty()) continue;  // features may not be known yet
      require_known(key, "observation_noise.std", "channel", label, labels);
    }
    require_all(deviations, labels);
  }

  const Study& study_;
  const sim::SimulatorInfo* info_;
};

}  // namespace

void check_noise(const Study& study, const sim::SimulatorInfo* info, Reading& reading) {
  NoiseChecker(study, info, reading).check();
}

}  // namespace npdr::pipeline
