#include "pipeline/config/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "core/error.h"
#include "core/text.h"
#include "inference/algorithms/pool_powers.h"
#include "pipeline/config/check.h"

namespace npdr::pipeline {
namespace {

// A parameter of the noise, where the model has it.
void add_parameter(std::string& text, const std::string& name, const std::optional<double>& value,
                   bool is_inferred) {
  if (is_inferred) {
    text += ", " + name + " inferred";
  } else if (value) {
    text += fmt::format(", {} {}", name, *value);
  }
}

// And again with the prefix.
std::vector<std::string> with_held_out(std::vector<std::string> names) {
  const std::vector<std::string> once = names;
  for (const std::string& name : once) names.push_back(std::string(kHeldOutPrefix) + name);
  return names;
}

}  // namespace

std::string to_text(const ObservationNoise& noise) {
  if (noise.is_silent()) return "none";
  std::string text = noise.is_correlated()     ? "correlated"
                     : noise.is_heavy_tailed() ? "heavy-tailed"
                                               : "white";
  if (noise.is_correlated() && noise.is_heavy_tailed()) text += " and heavy-tailed";
  if (noise.scale > 0.0 || noise.scale_prior) {
    add_parameter(text, "scale", noise.scale, noise.scale_prior.has_value());
  }
  for (const auto& [channel, deviation] : noise.std.value_or(std::map<std::string, double>())) {
    text += fmt::format(", std of {} {}", channel, deviation);
  }
  add_parameter(text, "correlation", noise.correlation, noise.correlation_prior.has_value());
  add_parameter(text, "degrees of freedom", noise.degrees_of_freedom,
                noise.degrees_of_freedom_prior.has_value());
  return text;
}

std::vector<double> PolicyGridAxis::points() const {
  if (!values.empty()) return values;
  std::vector<double> points;
  const auto last = static_cast<double>(steps - 1);
  for (Index i = 0; i < steps; ++i) {
    const double t = static_cast<double>(i) / last;
    points.push_back((1.0 - t) * range[0] + t * range[1]);
  }
  return points;
}

const MethodConfig& Study::method(const std::string& method_name) const {
  std::vector<std::string> names;
  for (const MethodConfig& m : methods) {
    if (m.name == method_name) return m;
    names.push_back(m.name);
  }
  throw InputError(unknown_name("method", method_name, names));
}

const MethodConfig* Study::floor_method() const {
  const auto fit = std::ranges::find_if(methods, [](const MethodConfig& method) {
    return family_of(method) == inference::AlgorithmFamily::fit;
  });
  return evaluate.floor && target.recording && fit != methods.end() ? &*fit : nullptr;
}

DiagnoseConfig Study::diagnose_of(const MethodConfig& method) const {
  DiagnoseConfig config = diagnose;
  if (!infers(method)) config.checks.clear();
  std::erase_if(config.checks, [&](Check check) {
    return !traits_of(check).why_unchecked(*this, method).empty();
  });
  return config;
}

Index Study::num_iterations_of(const MethodConfig& method) const {
  return policy.is_used() && infers(method) ? method.num_iterations : 1;
}

inference::AlgorithmFamily family_of(const MethodConfig& method) {
  return inference::traits_of(method.algorithm.kind).family;
}

bool infers(const MethodConfig& method) {
  return family_of(method) != inference::AlgorithmFamily::fixed;
}

bool learns_from_rounds(inference::Algorithm algorithm) {
  using enum inference::AlgorithmFamily;
  const inference::AlgorithmFamily family = inference::traits_of(algorithm).family;
  return family == network || family == abc;
}

bool learns(const MethodConfig& method) { return learns_from_rounds(method.algorithm.kind); }

Index num_learned_from(const MethodConfig& method) {
  const Index count = method.algorithm.num_simulations;
  const bool is_pooled = method.algorithm.kind == inference::Algorithm::npe_nle;
  return is_pooled ? count - inference::num_judging_rows(count) : count;
}

bool DiagnoseConfig::has(Check check) const {
  return std::ranges::find(checks, check) != checks.end();
}

bool DiagnoseConfig::calibrates() const {
  return std::ranges::any_of(
      checks, [](Check check) { return traits_of(check).input == CheckInput::calibration; });
}

DiagnoseConfig DiagnoseConfig::of_diagnosis() const {
  DiagnoseConfig config = *this;
  std::erase_if(config.checks,
                [](Check check) { return traits_of(check).input == CheckInput::samples; });
  return config;
}

std::vector<std::string> measured_names(const Study& study) {
  const std::vector<std::string> names = to_names(study.evaluate.metrics);
  return study.target.held_out > 0 ? with_held_out(names) : names;
}

std::vector<std::string> all_measured_names() { return with_held_out(names_of<Metric>()); }

std::string folder_slug(const std::string& name) {
  std::string folder;
  for (const char c : name) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isalnum(letter)) {
      folder += static_cast<char>(std::tolower(letter));
    } else if (!folder.empty() && folder.back() != '-') {
      folder += '-';
    }
  }
  while (!folder.empty() && folder.back() == '-') folder.pop_back();
  return folder.empty() ? "unnamed" : folder;
}

}  // namespace npdr::pipeline
