#include "pipeline/config/checker.h"

#include <filesystem>
#include <system_error>

namespace npdr::pipeline {

void Checker::require_there(const std::string& path, bool is_there, const std::string& words) {
  if (!is_there && reading_.good(path)) fail(path, path + " is missing, must be " + words);
}

bool Checker::require_one_of(const std::string& path, bool has_first, const std::string& first,
                             bool has_second, const std::string& second) {
  if (has_first != has_second) return true;
  fail(path, fmt::format("{} has {} {} {} {}, must have one of them", path,
                         has_first ? "both" : "neither", first, has_first ? "and" : "nor", second));
  return false;
}

void Checker::must_be_left_out(std::initializer_list<std::string> paths, const std::string& why) {
  for (const std::string& path : paths) must_be_left_out({{path, {.unused = ": " + why}}});
}

void Checker::must_be_left_out(const std::vector<UnusedField>& fields) {
  for (const auto& [path, use] : fields) {
    if (!reading_.has(path) || (use.settable && !is_in_file(path))) continue;
    fail(path, display(path) + " must be left out" + use.unused);
  }
}

bool Checker::is_in_file(const std::string& path) const {
  return reading_.has(path) && !reading_.place(path).is_override();
}

bool Checker::require_known(const std::string& path, const std::string& where,
                            const std::string& kind, const std::string& name,
                            const std::vector<std::string>& known) {
  if (std::ranges::find(known, name) != known.end()) return true;
  fail(path, where + ": " + unknown_name(kind, shortened(name), known));
  return false;
}

const sim::Parameter* Checker::find_parameter(const std::string& path, const std::string& where,
                                              const std::string& name) {
  std::vector<std::string> names;
  for (const sim::Parameter& parameter : info_->parameters) names.push_back(parameter.name);
  if (!require_known(path, where, "parameter", name, names)) return nullptr;
  return &*std::ranges::find(info_->parameters, name, &sim::Parameter::name);
}

void Checker::check_value(const std::string& path, const sim::Parameter& parameter, double value) {
  if (value >= parameter.lower && value <= parameter.upper) return;
  reading_.reject(
      path, fmt::format("{}", value),
      fmt::format("between {} and {} {}", parameter.lower, parameter.upper, parameter.unit));
}

bool Checker::check_values(const std::string& path, const std::map<std::string, double>& values) {
  bool are_sound = true;
  if (info_ == nullptr) return are_sound;
  for (const auto& [name, value] : values) {
    const std::string member = path + "." + name;
    const sim::Parameter* parameter = find_parameter(member, display(path), name);
    if (parameter != nullptr && reading_.good(member)) check_value(member, *parameter, value);
    are_sound &= reading_.good(member);
  }
  return are_sound;
}

void Checker::require_file(const std::string& path, const std::string& file,
                           const std::string& words) {
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(file, unreadable)) {
    reading_.reject(path, quoted(file), words);
  }
}

}  // namespace npdr::pipeline
