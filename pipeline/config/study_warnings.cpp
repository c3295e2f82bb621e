#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/text.h"
#include "pipeline/config/check.h"
#include "pipeline/config/study_check.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

using inference::Marginal;

// A study, and what is known of its simulator.
struct Subject {
  const Study& study;
  const sim::SimulatorInfo& info;

  Findings warn(const std::string& path, std::string text) const {
    return {warning(std::move(text), study.places.of(path).str())};
  }
};

Findings find_outside(const Subject& s, const Marginal& marginal, double value,
                      const std::string& path, const std::string& name) {
  if (!(value < marginal.lower() || value > marginal.upper())) return {};
  return s.warn(path, fmt::format("{} = {}, outside of the prior, [{}, {}]: no posterior can hold "
                                  "it; widen prior.{}",
                                  name, value, marginal.lower(), marginal.upper(), marginal.name));
}

// A truth has nominal parameters where it doesn't say otherwise.
Findings find_truth_outside(const Subject& s) {
  Findings found;
  for (const Marginal& marginal : s.study.prior) {
    const std::string& name = marginal.name;
    const auto given = s.study.target.truth->find(name);
    if (given != s.study.target.truth->end()) {
      const std::string path = "target.truth." + name;
      append(found, find_outside(s, marginal, given->second, path, path));
    } else {
      const auto p = static_cast<std::size_t>(sim::parameter_index(s.info, name));
      append(found, find_outside(s, marginal, s.info.parameters[p].nominal, "prior." + name,
                                 "the truth's " + name + ", its nominal value"));
    }
  }
  return found;
}

Findings find_references_outside(const Subject& s) {
  Findings found;
  for (std::size_t i = 0; i < s.study.references.size(); ++i) {
    const ReferenceConfig& reference = s.study.references[i];
    for (const Marginal& marginal : s.study.prior) {
      const auto given = reference.parameters.find(marginal.name);
      if (given == reference.parameters.end()) continue;
      append(found,
             find_outside(s, marginal, given->second,
                          fmt::format("reference[{}].parameters.{}", i, marginal.name),
                          fmt::format("{} of reference '{}'", marginal.name, reference.name)));
    }
  }
  return found;
}

// Simulators of the user's may draw it; they are asked when they run (sources/first_rows.h).
Findings find_exact_channels(const Subject& s) {
  const SourceTraits& source = s.study.source();
  const ObservationNoise& noise = s.study.observation_noise;
  const bool is_meant = s.study.places.has("observation_noise.scale") || noise.scale_prior;
  if (!s.study.target.recording || !source.simulates || is_meant ||
      !std::ranges::any_of(s.study.methods, learns)) {
    return {};
  }
  std::vector<std::string> exact = labels_of(s.info.state_channels);
  std::erase_if(exact, [&](const auto& label) { return noise.std && noise.std->contains(label); });
  if (exact.empty()) return {};
  return s.warn(
      "observation_noise.std",
      fmt::format("observation_noise leaves {} without noise: {}methods learn from "
                  "simulations that no recording is like, and may miss the truth; set "
                  "scale, std by channel, or scale_prior where nobody knows it; 0 says "
                  "that there is none",
                  join(exact), source.is_built_in ? "" : "unless the simulator draws it, "));
}

// Of motion the scale is a share of what was recorded; features' noise may be anything.
Findings find_loud_noise(const Subject& s) {
  const ObservationNoise& noise = s.study.observation_noise;
  if (!s.study.source().gives_motion || noise.scale < 1.0 || noise.std) return {};
  return s.warn("observation_noise.scale",
                fmt::format("observation_noise.scale = {}: noise as large as the motion leaves "
                            "little to infer from; it is a share of each channel's largest "
                            "magnitude, such as 0.02",
                            noise.scale));
}

Findings find_recorded_states(const Subject& s) {
  const bool compares = std::ranges::any_of(
      s.study.evaluate.metrics, [](Metric m) { return m == Metric::rmse || m == Metric::dtw; });
  if (!s.study.source().gives_motion || s.study.simulator.segment_length != 1 || !compares) {
    return {};
  }
  return s.warn(
      "simulator.segment_length",
      "simulator.segment_length = 1: rmse and dtw compare the states before each action, and "
      "with segments of a step all of them are recorded ones: they are 0 for any parameters; "
      "inference and scores are not concerned");
}

// Those that no method can be put to.
Findings find_checks_left_out(const Subject& s) {
  if (!s.study.places.has("diagnose.checks")) return {};
  std::map<std::string, std::vector<std::string>> left_out;  // by the reason of the first method
  for (const Check check : s.study.diagnose.checks) {
    std::vector<std::string> reasons;  // "" of a method that can be
    for (const MethodConfig& method : s.study.methods) {
      if (infers(method)) reasons.push_back(traits_of(check).why_unchecked(s.study, method));
    }
    if (reasons.empty() || std::ranges::count(reasons, "") > 0) continue;
    left_out[reasons.front()].push_back(name_of(check));
  }
  Findings found;
  for (const auto& [reason, checks] : left_out) {
    append(found, s.warn("diagnose.checks",
                         fmt::format("diagnose.checks: without {}: {}", join(checks), reason)));
  }
  return found;
}

// Where simulations run, it may be there: on the nodes of a cluster, or after 'module load'.
Findings find_unknown_program(const Subject& s) {
  const auto& worker = s.study.external.worker;
  const std::string& command = worker ? *worker : *s.study.external.command;
  const std::string program = unknown_program(command);
  if (program.empty()) return {};
  const std::string path = worker ? "simulator.worker" : "simulator.command";
  return s.warn(path, fmt::format("{} = {}: there is no program {} on the PATH; correct its name, "
                                  "or install it where simulations run",
                                  path, quoted(command), quoted(program)));
}

constexpr std::array<Probe<Subject>, 7> kProbes = {{
    {"truth_outside", find_truth_outside,
     [](const Subject& s) { return s.study.target.truth.has_value(); }},
    {"reference_outside", find_references_outside},
    {"recording_without_noise", find_exact_channels},
    {"loud_noise", find_loud_noise},
    {"recorded_states_compared", find_recorded_states},
    {"checks_left_out", find_checks_left_out},
    {"unknown_program", find_unknown_program,
     [](const Subject& s) { return s.study.source().calls_program; }},
}};

}  // namespace

Findings warnings_of(const Study& study, const sim::SimulatorInfo& info) {
  return find_by(kProbes, Subject{study, info});
}

}  // namespace npdr::pipeline
