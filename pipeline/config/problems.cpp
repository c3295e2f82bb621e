#include "pipeline/config/problems.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "core/error.h"
#include "core/text.h"

namespace npdr::pipeline {

void Problems::add(const Place& place, const std::string& message) {
  problems_.push_back({place, message});
}

void Problems::throw_if_any() const {
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

void Reading::fail(const std::string& path, const std::string& message) {
  fail(path, place(path), message);
}

void Reading::fail(const std::string& path, const Place& place, const std::string& message) {
  problems_.add(place, message);
  failed_.push_back(path);
}

bool Reading::good(const std::string& path) const {
  const auto inside = [](const std::string& inner, const std::string& outer) {
    return !outer.empty() && inner.starts_with(outer) &&
           (inner.size() == outer.size() || inner[outer.size()] == '.' ||
            inner[outer.size()] == '[');
  };
  return std::none_of(failed_.begin(), failed_.end(), [&](const std::string& failed) {
    return inside(failed, path) || inside(path, failed);
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
