// What libFuzzer calls. The environment names the target (NPDR_FUZZ_TARGET); where its seeds go,
// and what to begin with, is the first folder of the command line.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>

#include "tests/fuzz/fuzz_target.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

const FuzzTarget& chosen_target() {
  const char* const name = std::getenv("NPDR_FUZZ_TARGET");
  for (const FuzzTarget& target : kFuzzTargets) {
    if (name != nullptr && target.name == name) return target;
  }
  std::fputs("NPDR_FUZZ_TARGET must be one of", stderr);
  for (const FuzzTarget& target : kFuzzTargets) std::fprintf(stderr, " %s", target.name.c_str());
  std::fputs("\n", stderr);
  std::exit(2);
}

void write_seeds(const FuzzTarget& target, const std::filesystem::path& folder) {
  std::size_t i = 0;
  for (const std::string& seed : target.seeds()) {
    std::ofstream(folder / ("seed-" + std::to_string(++i)), std::ios::binary) << seed;
  }
}

}  // namespace
}  // namespace npdr::pipeline

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  if (*argc > 1 && std::filesystem::is_directory((*argv)[1])) {
    npdr::pipeline::write_seeds(npdr::pipeline::chosen_target(), (*argv)[1]);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const char* data, std::size_t size) {
  static const npdr::pipeline::FuzzTarget& target = npdr::pipeline::chosen_target();
  static const npdr::TempFolder folder;
  npdr::pipeline::accepts(target, {data, size}, folder.path());
  return 0;
}
