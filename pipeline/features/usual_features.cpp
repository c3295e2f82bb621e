#include "pipeline/features/usual_features.h"

#include <algorithm>

namespace npdr::pipeline {

std::optional<inference::UsualFeatures> usual_features_of(const SimulationFeatures& features,
                                                          Index most_rows, const StreamId& stream) {
  constexpr Index most_values = 10'000'000;
  constexpr Index fewest = inference::kFewestSimulations;
  if (features.num_rows() < fewest) return std::nullopt;
  const Index allowed = std::clamp(most_values / features.num_features(), 2 * fewest, most_rows);
  auto rows = Stream(stream).permutation(static_cast<std::uint32_t>(features.num_rows()));
  rows.resize(static_cast<std::size_t>(std::min(allowed, features.num_rows())));
  RowMatrixF x;
  features.gather(rows, 0, x);
  return inference::usual_features(x);
}

}  // namespace npdr::pipeline
