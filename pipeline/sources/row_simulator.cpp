#include "pipeline/sources/row_simulator.h"

namespace npdr::pipeline {

std::filesystem::path log_of(const std::filesystem::path& artefact) {
  return std::filesystem::path(artefact).replace_extension(".log");
}

}  // namespace npdr::pipeline
