/// Sizes for people.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>

namespace npdr::pipeline {

/// "512 B", "3.4 KiB", "1.2 GiB".
inline std::string size_text(std::uintmax_t bytes) {
  if (bytes < 1024) return fmt::format("{} B", bytes);
  auto value = static_cast<double>(bytes);
  for (const char* unit : {"KiB", "MiB", "GiB"}) {
    value /= 1024.0;
    if (value < 1024.0) return fmt::format("{:.1f} {}", value, unit);
  }
  return fmt::format("{:.1f} TiB", value / 1024.0);
}

}  // namespace npdr::pipeline
