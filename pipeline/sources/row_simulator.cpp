#include "pipeline/sources/row_simulator.h"

namespace npdr::pipeline {

std::uint32_t row_seed(StreamId first, Index i) {
  first.row += static_cast<std::uint64_t>(i);
  return Stream(first).bits() >> 1;
}

std::filesystem::path log_of(const std::filesystem::path& artefact) {
  return std::filesystem::path(artefact).replace_extension(".log");
}

}  // namespace npdr::pipeline
