#include "pipeline/sources/row_simulator.h"

namespace npdr::pipeline {

sim::Segments feature_segments(Index num_features) {
  return {.dt = 1.0,
          .num_rollouts = 1,
          .steps = {1},
          .past = {0},
          .first_states = RowMatrix::Zero(1, num_features),
          .actions = RowMatrix(1, 0)};
}

std::uint32_t row_seed(StreamId first, Index i) {
  first.row += static_cast<std::uint64_t>(i);
  return Stream(first).bits() >> 1;
}

std::filesystem::path log_of(const std::filesystem::path& artefact) {
  return std::filesystem::path(artefact).replace_extension(".log");
}

}  // namespace npdr::pipeline
