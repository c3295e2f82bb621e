// Some inputs of each target, the same in each run: seeds with some bytes changed. Many
// more are tried by scripts/fuzz, which looks for those that lead somewhere new.
#include <gtest/gtest.h>

#include "core/random.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
// Else names of tests would have the bytes of pointers.
void PrintTo(const FuzzTarget& target, std::ostream* stream) { *stream << target.name; }

namespace {

std::string changed(std::string input, std::uint64_t row) {
  Stream random({1, "fuzz", 0, row, 0});
  const auto num_bytes = 1 + random.below(12);
  for (std::uint32_t i = 0; i < num_bytes; ++i) {
    const std::size_t at = random.below(static_cast<std::uint32_t>(input.size() + 1));
    const char byte = static_cast<char>(random.below(256));
    // Behind a short one, bytes are further choices.
    if (at == input.size() || input.size() < 40) {
      input += byte;
    } else if (random.below(4) == 0) {
      input.erase(at, 1 + random.below(8));
    } else {
      input[at] = byte;
    }
  }
  return input;
}

class Fuzz : public ::testing::TestWithParam<FuzzTarget> {};

TEST_P(Fuzz, SeedsAreAccepted) {
  const TempFolder folder;
  for (const std::string& seed : GetParam().seeds()) {
    EXPECT_NO_THROW(GetParam().run(seed, folder.path())) << testing::PrintToString(seed);
  }
}

TEST_P(Fuzz, ChangedSeedsAreAcceptedOrRefused) {
  const TempFolder folder;
  const std::vector<std::string> seeds = GetParam().seeds();
  const bool needs_no_file = GetParam().name == "study" || GetParam().name == "csv";
  const std::uint64_t num_inputs = needs_no_file ? 2000 : 300;
  for (std::uint64_t i = 0; i < num_inputs; ++i) {
    const std::string input = changed(seeds[i % seeds.size()], i);
    EXPECT_NO_THROW(accepts(GetParam(), input, folder.path())) << testing::PrintToString(input);
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, Fuzz, ::testing::ValuesIn(kFuzzTargets),
                         [](const auto& target) { return target.param.name; });

}  // namespace
}  // namespace npdr::pipeline
