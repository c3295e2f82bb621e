#include "pipeline/config/noise_check.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "pipeline/config/checker.h"

namespace npdr::pipeline {
namespace {

class NoiseChecker : Checker {
 public:
  NoiseChecker(const Study& study, const sim::SimulatorInfo* info, Reading& reading)
      : Checker(reading), study_(study), info_(info) {}

  void check() {
    const ObservationNoise& noise = study_.observation_noise;
    check_one("scale", noise.scale > 0.0, "scale_prior", noise.scale_prior.has_value());
    check_one("correlation", noise.correlation.has_value(), "correlation_prior",
              noise.correlation_prior.has_value());
    check_one("degrees_of_freedom", noise.degrees_of_freedom.has_value(),
              "degrees_of_freedom_prior", noise.degrees_of_freedom_prior.has_value());
    if (noise.is_silent()) {
      check_silent();
    } else if (!study_.source().gives_motion) {
      check_features();
    }
    if (noise.std) check_channels(*noise.std);
  }

 private:
  // A number is given, or its prior.
  void check_one(const std::string& number, bool is_given, const std::string& prior,
                 bool has_prior) {
    if (is_given && has_prior) {
      must_be_left_out("observation_noise." + prior, "observation_noise." + number + " is given");
    }
  }

  void check_silent() {
    for (const char* key :
         {"correlation", "correlation_prior", "degrees_of_freedom", "degrees_of_freedom_prior"}) {
      must_be_left_out(std::string("observation_noise.") + key,
                       "there is no noise without observation_noise.scale, scale_prior or std");
    }
  }

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
    std::vector<std::string> labels;
    if (info_ != nullptr) {
      for (const Channel& channel : info_->state_channels) labels.push_back(channel.label);
    }
    for (const auto& [label, deviation] : deviations) {
      const std::string key = "observation_noise.std." + label;
      if (!(deviation >= 0.0)) fail(key, fmt::format("{}", deviation), ">= 0");
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
