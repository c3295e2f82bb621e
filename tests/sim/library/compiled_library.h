/// Shared libraries that tests compile as a user does: with one compiler line, outside of the
/// project.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace npdr::sim {

/// Compiles `source` with the system's compiler and npdr's header alone. `options`: such as -D.
inline std::filesystem::path compile_library(const std::filesystem::path& source,
                                             const std::filesystem::path& library,
                                             const std::string& options = "") {
  const char* const compiler = source.extension() == ".c" ? "cc" : "c++";
  const std::string command =
      fmt::format("{} -O2 -shared -fPIC {} -I'{}/include' '{}' -o '{}' -lm", compiler, options,
                  NPDR_BINARY_DIR, source.string(), library.string());
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  return library;
}

/// The example of a user's library: a mass on a spring.
inline std::filesystem::path spring_source() {
  return std::filesystem::path(NPDR_SOURCE_DIR) / "experiments/external/spring/spring.c";
}

}  // namespace npdr::sim
