#include "pipeline/config/checker.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "core/text.h"
#include "pipeline/config/constraint.h"

namespace npdr::pipeline {

void Checker::fail(const std::string& path, const std::string& found, const std::string& words) {
  reading_.fail(path, must_be(display(path), found, words));
}

void Checker::must_be_left_out(const std::string& path, const std::string& why) {
  must_be_left_out({{path, {.unused = unless(false, why)}}});
}

void Checker::must_be_left_out(const std::vector<UnusedField>& fields) {
  for (const auto& [path, use] : fields) {
    if (!reading_.has(path) || (use.settable && !is_in_file(path))) continue;
    reading_.fail(path, display(path) + " must be left out" + use.unused);
  }
}

bool Checker::is_in_file(const std::string& path) const {
  return reading_.has(path) && !reading_.place(path).is_override();
}

bool Checker::require_known(const std::string& path, const std::string& where,
                            const std::string& kind, const std::string& name,
                            const std::vector<std::string>& known) {
  if (std::ranges::find(known, name) != known.end()) return true;
  reading_.fail(path, where + ": " + unknown_name(kind, shortened(name), known));
  return false;
}

const sim::Parameter* Checker::find_parameter(const std::string& path, const std::string& where,
                                              const sim::SimulatorInfo& info,
                                              const std::string& name) {
  std::vector<std::string> names;
  for (const sim::Parameter& parameter : info.parameters) names.push_back(parameter.name);
  if (!require_known(path, where, "parameter", name, names)) return nullptr;
  return &*std::ranges::find(info.parameters, name, &sim::Parameter::name);
}

void Checker::check_value(const std::string& path, const sim::Parameter& parameter, double value) {
  if (value >= parameter.lower && value <= parameter.upper) return;
  fail(path, fmt::format("{}", value),
       fmt::format("between {} and {} {}", parameter.lower, parameter.upper, parameter.unit));
}

std::vector<std::string> Checker::labels_of(const std::vector<Channel>& channels) {
  std::vector<std::string> labels;
  for (const Channel& channel : channels) labels.push_back(channel.label);
  return labels;
}

void Checker::require_file(const std::string& path, const std::string& file,
                           const std::string& words) {
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(file, unreadable)) fail(path, quoted(file), words);
}

}  // namespace npdr::pipeline
