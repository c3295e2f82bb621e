#include <array>
#include <utility>

#include "core/error.h"
#include "core/text.h"
#include "inference/algorithms/algorithm_config.h"

namespace npdr::inference {
namespace {

// Names that older papers and tools use for the same algorithm.
constexpr std::array<std::pair<const char*, const char*>, 3> kOlderSpellings = {{
    {"snpe_c", "npe_c"},
    {"snpe-c", "npe_c"},
    {"apt", "npe_c"},
}};

}  // namespace

std::vector<std::string> algorithm_names() { return {"npe_c"}; }

std::string canonical_algorithm(const std::string& spelling) {
  for (const std::string& name : algorithm_names()) {
    if (spelling == name) return name;
  }
  for (const auto& [older, name] : kOlderSpellings) {
    if (spelling == older) return name;
  }
  throw InputError(unknown_name("algorithm", spelling, algorithm_names()));
}

}  // namespace npdr::inference
