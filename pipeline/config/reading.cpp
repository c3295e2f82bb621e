#include "pipeline/config/reading.h"

#include <algorithm>
#include <string_view>
#include <tuple>

#include "core/error.h"
#include "core/text.h"

namespace npdr::pipeline {

void Reading::throw_if_bad() const {
  if (problems_.empty()) return;
  std::vector<Problem> sorted = problems_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Problem& a, const Problem& b) {
    return std::tie(a.place.line, a.place.column) < std::tie(b.place.line, b.place.column);
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
