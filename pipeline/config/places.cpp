#include "pipeline/config/places.h"

namespace npdr::pipeline {

std::string Place::str() const {
  if (line == 0) return origin;
  return origin + ":" + std::to_string(line) + ":" + std::to_string(column);
}

Place Places::of(const std::string& path) const {
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
