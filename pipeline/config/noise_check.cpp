#include "pipeline/config/checker.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

class NoiseChecker : Checker {
 public:
  using Checker::Checker;

  void check() {
    const ObservationNoise& noise = study_.observation_noise;
    must_be_left_out(unused_fields(fields_of(noise), "observation_noise"));
    if (!noise.is_silent() && !study_.source().gives_motion) {
      must_be_left_out({"observation_noise.correlation", "observation_noise.correlation_prior"},
                       "the simulator gives features, which have no neighbors in time");
    }
    if (noise.std) check_channels(*noise.std);
  }

 private:
  void check_channels(const std::map<std::string, double>& deviations) {
    const auto labels = info_ ? labels_of(info_->state_channels) : std::vector<std::string>();
    for (const auto& [label, deviation] : deviations) {
      const std::string key = "observation_noise.std." + label;
      require(key, deviation, deviation >= 0.0, ">= 0");
      if (labels.empty()) continue;  // features may not be known yet
      require_known(key, "observation_noise.std", "channel", label, labels);
    }
    const bool refines = std::ranges::any_of(study_.methods, [](const MethodConfig& method) {
      return method.algorithm.kind == inference::Algorithm::refine;
    });
    if (refines) require_all(deviations, labels);
  }

  // The likelihood of a refinement is that of every channel's noise.
  void require_all(const std::map<std::string, double>& deviations,
                   std::vector<std::string> missing) {
    const ObservationNoise& noise = study_.observation_noise;
    const std::string needed = "algorithm 'refine' needs noise in each channel";
    for (const auto& [label, deviation] : deviations) {
      require("observation_noise.std." + label, deviation, deviation != 0.0, "> 0: " + needed);
    }
    std::erase_if(missing, [&](const std::string& label) { return deviations.contains(label); });
    if (missing.empty() || noise.scale > 0.0 || noise.scale_prior) return;
    reading_.reject("observation_noise.std", "without " + join(missing),
                    "of all channels, or beside a scale or scale_prior of the others: " + needed);
  }
};

}  // namespace

void check_noise(const Study& study, const sim::SimulatorInfo* info, Reading& reading) {
  NoiseChecker(study, info, reading).check();
}

}  // namespace npdr::pipeline
