#include "tests/fuzz/fuzz_target.h"

#include <cstdio>
#include <cstdlib>

#include "core/error.h"

namespace npdr::pipeline {

bool accepts(const FuzzTarget& target, std::string_view input,
             const std::filesystem::path& folder) {
  try {
    target.run(input, folder);
    return true;
  } catch (const Error& error) {
    const std::string message = error.what();
    constexpr std::string_view crash = "the HDF5 library crashes on it";
    const bool is_quoted = input.find(crash) != std::string_view::npos;  // fuzzers learn such words
    if (is_quoted || message.find(crash) == std::string::npos) return false;
    std::fprintf(stderr, "%s\n", message.c_str());
    std::abort();
  }
}

}  // namespace npdr::pipeline
