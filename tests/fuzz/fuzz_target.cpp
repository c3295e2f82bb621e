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
    if (message.find("the HDF5 library crashes on it") == std::string::npos) return false;
    std::fprintf(stderr, "%s\n", message.c_str());
    std::abort();
  }
}

}  // namespace npdr::pipeline
