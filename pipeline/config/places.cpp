#include "pipeline/config/places.h"

namespace npdr::pipeline {

std::string Place::str() const {
  if (line == 0) return origin;
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

}  // namespace npdr::pipeline
