#include "pipeline/config/reading.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "core/text.h"

namespace npdr::pipeline {

std::string Place::str() const {
  if (line == 0 || is_override()) return origin;
  return origin + ":" + std::to_string(line) + ":" + std::to_string(column);
}

bool Place::is_override() const { return origin.starts_with(kOverride); }

Place Places::of(const std::string& path) const {
  const auto exact = places_.find(path);
  const bool is_known =
      exact != places_.end() && (exact->second.line > 0 || exact->second.origin != origin_);
  const auto below = places_.lower_bound(path + ".");
  if (!is_known && below != places_.end() && below->first.starts_with(path + ".")) {
    return below->second;
  }
  std::string ancestor = path;
  while (!ancestor.empty()) {
    const auto found = places_.find(ancestor);
    if (found != places_.end()) return found->second;
    const std::size_t end = ancestor.find_last_of(".[");
    ancestor.resize(end == std::string::npos ? 0 : end);
  }
  return {origin_};
}

void Reading::throw_if_bad() const {
  if (problems_.empty()) return;
  std::vector<Problem> sorted = problems_;
  std::ranges::stable_sort(sorted, {}, [](const Problem& problem) {
    const auto& [origin, line, column] = problem.place;
    return problem.place.is_override() ? std::pair(0, 0) : std::pair(line, column);
  });
  constexpr std::size_t most = 50;  // who has more has misunderstood something
  std::set<std::string> told;
  std::vector<std::string> lines;
  for (const Problem& problem : sorted) {
    std::string line = problem.place.str() + ": " + problem.message;
    if (told.insert(line).second && told.size() <= most) lines.push_back(line);
  }
  if (told.size() > most) {
    lines.push_back("and " + std::to_string(told.size() - most) + " more problems");
  }
  throw InputError(join(lines, "\n"));
}

KeySource Reading::source(const std::string& path) const {
  const auto found = sources_.find(path);
  return found == sources_.end() ? KeySource{{origin()}, {origin()}} : found->second;
}

void Reading::fail(const std::string& path, const Place& place, const std::string& message) {
  problems_.push_back({place, message});
  failed_.insert(path);
}

bool Reading::good(const std::string& path) const {
  if (path.empty()) return true;
  for (std::size_t end = path.size(); end != 0 && end != std::string::npos;
       end = path.find_last_of(".[", end - 1)) {
    if (failed_.contains(path.substr(0, end))) return false;
  }
  return std::ranges::none_of(std::string_view(".["), [&](char separator) {
    const std::string members = path + separator;
    const auto failed = failed_.lower_bound(members);
    return failed != failed_.end() && failed->starts_with(members);
  });
}

std::string display(const std::string& path) {
  std::string result;
  bool inside = false;
  for (const char c : path) {
    if (c == '[') inside = true;
    if (!inside) result += c;
    if (c == ']') inside = false;
  }
  return result;
}

}  // namespace npdr::pipeline
