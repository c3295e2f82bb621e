#include "pipeline/config/study_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "core/text.h"
#include "pipeline/config/check.h"
#include "pipeline/config/program_check.h"

namespace npdr::pipeline {
namespace {

using inference::Marginal;
using Numbers = std::map<std::string, double>;

class StudyWarnings {
 public:
  StudyWarnings(const Study& study, const sim::SimulatorInfo& info) : study_(study), info_(info) {}

  std::vector<std::string> all() {
    if (study_.target.truth) warn_of_truth();
    for (std::size_t i = 0; i < study_.references.size(); ++i) warn_of_reference(i);
    warn_of_exact_recording();
    warn_of_exact_channels();
    warn_of_loud_noise();
    warn_of_recorded_states();
    warn_of_checks_left_out();
    if (study_.source().calls_program) warn_of_program();
    return std::move(warnings_);
  }

 private:
  void warn(const std::string& path, const std::string& text) {
    warnings_.push_back(study_.places.of(path).str() + ": warning: " + text);
  }

  void require_inside(const Marginal& marginal, double value, const std::string& path,
                      const std::string& name) {
    if (!(value < marginal.lower() || value > marginal.upper())) return;
    warn(path, fmt::format("{} = {}, outside of the prior, [{}, {}]: no posterior can hold it; "
                           "widen prior.{}",
                           name, value, marginal.lower(), marginal.upper(), marginal.name));
  }

  // A truth has nominal parameters where it doesn't say otherwise.
  void warn_of_truth() {
    for (const Marginal& marginal : study_.prior) {
      const auto given = study_.target.truth->find(marginal.name);
      if (given != study_.target.truth->end()) {
        const std::string path = "target.truth." + marginal.name;
        require_inside(marginal, given->second, path, path);
        continue;
      }
      const Index p = sim::parameter_index(info_, marginal.name);
      require_inside(marginal, info_.parameters[static_cast<std::size_t>(p)].nominal,
                     "prior." + marginal.name,
                     "the truth's " + marginal.name + ", its nominal value");
    }
  }

  void warn_of_reference(std::size_t i) {
    const ReferenceConfig& reference = study_.references[i];
    for (const Marginal& marginal : study_.prior) {
      const auto given = reference.parameters.find(marginal.name);
      if (given == reference.parameters.end()) continue;
      require_inside(marginal, given->second,
                     fmt::format("reference[{}].parameters.{}", i, marginal.name),
                     fmt::format("{} of reference '{}'", marginal.name, reference.name));
    }
  }

  void warn_of_exact_channels() {
    const ObservationNoise& noise = study_.observation_noise;
    if (!study_.target.recording || !noise.std || noise.scale > 0.0 || noise.scale_prior) return;
    std::vector<std::string> exact;
    for (const Channel& channel : info_.state_channels) {
      if (!noise.std->contains(channel.label)) exact.push_back(channel.label);
    }
    if (exact.empty()) return;
    warn(
        "observation_noise.std",
        fmt::format("observation_noise.std leaves {} without noise, to which no recording is "
                    "alike: give it, or 0 where there is none, or a scale beside it for the others",
                    join(exact)));
  }

  // Of motion the scale is a share of what was recorded; features' noise may be anything.
  void warn_of_loud_noise() {
    const ObservationNoise& noise = study_.observation_noise;
    if (!study_.source().gives_motion || noise.scale < 1.0 || noise.std) return;
    warn("observation_noise.scale",
         fmt::format("observation_noise.scale = {}: noise as large as the motion leaves "
                     "little to infer from; it is a share of each channel's largest magnitude, "
                     "such as 0.02; std gives a channel's noise in its own unit",
                     noise.scale));
  }

  void warn_of_recorded_states() {
    const auto& metrics = study_.evaluate.metrics;
    const bool compares = std::ranges::any_of(
        metrics, [](Metric m) { return m == Metric::rmse || m == Metric::dtw; });
    if (!study_.source().gives_motion || study_.simulator.segment_length != 1 || !compares) return;
    warn("simulator.segment_length",
         "simulator.segment_length = 1: rmse and dtw compare the states before each action, and "
         "with segments of a step all of them are recorded ones: they are 0 for any parameters; "
         "inference and scores are not concerned");
  }

  // Those that no method can be put to.
  void warn_of_checks_left_out() {
    if (!study_.places.has("diagnose.checks")) return;
    std::map<std::string, std::vector<std::string>> left_out;  // by the reason of the first method
    for (const Check check : study_.diagnose.checks) {
      std::vector<std::string> reasons;  // "" of a method that can be
      for (const MethodConfig& method : study_.methods) {
        if (infers(method)) reasons.push_back(study_.why_unchecked(check, method));
      }
      if (reasons.empty() || std::ranges::count(reasons, "") > 0) continue;
      left_out[reasons.front()].push_back(name_of(check));
    }
    for (const auto& [reason, checks] : left_out) {
      warn("diagnose.checks", fmt::format("diagnose.checks: without {}: {}", join(checks), reason));
    }
  }

  // Simulators of the user's may draw it; they are asked when they run (sources/row_check.h).
  void warn_of_exact_recording() {
    const bool any_learns = std::ranges::any_of(study_.methods, learns);
    const bool is_meant = study_.places.has("observation_noise.scale");
    if (!study_.target.recording || !study_.source().simulates || !any_learns || is_meant ||
        !study_.observation_noise.is_silent()) {
      return;
    }
    warn("observation_noise",
         fmt::format("observation_noise has no scale, and the target is a recording: {}methods "
                     "learn from simulations without the noise that sensors have, to which no "
                     "recording is alike, and their posteriors may miss the truth; set "
                     "observation_noise.scale, std by channel, or scale_prior where nobody knows "
                     "it; scale = 0 says that there is none",
                     study_.source().is_built_in ? "" : "unless the simulator draws it, "));
  }

  // Where simulations run, it may be there: on the nodes of a cluster, or after 'module load'.
  void warn_of_program() {
    const auto& worker = study_.external.worker;
    const std::string& command = worker ? *worker : *study_.external.command;
    const std::string program = unknown_program(command);
    if (program.empty()) return;
    const std::string path = worker ? "simulator.worker" : "simulator.command";
    warn(path, fmt::format("{} = {}: there is no program {} on the PATH; correct its name, or "
                           "install it where simulations run",
                           path, quoted(command), quoted(program)));
  }

  const Study& study_;
  const sim::SimulatorInfo& info_;
  std::vector<std::string> warnings_;
};

}  // namespace

std::vector<std::string> warnings_of(const Study& study, const sim::SimulatorInfo& info) {
  return StudyWarnings(study, info).all();
}

}  // namespace npdr::pipeline
