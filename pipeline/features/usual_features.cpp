#include "pipeline/features/usual_features.h"

#include <algorithm>
#include <vector>

namespace npdr::pipeline {

std::optional<inference::UsualFeatures> usual_features_of(const inference::FeatureSource& features,
                                                          inference::Tails tails, Index most_rows,
                                                          const StreamId& stream) {
  constexpr Index fewest = inference::kFewestSimulations;
  if (features.num_rows() < fewest) return std::nullopt;
  const Index allowed =
      std::clamp(10'000 * most_rows / features.num_features(), 2 * fewest, most_rows);
  auto rows = Stream(stream).permutation(static_cast<std::uint32_t>(features.num_rows()));
  rows.resize(static_cast<std::size_t>(std::min(allowed, features.num_rows())));
  RowMatrixF x;
  features.gather(rows, 0, x);
  std::vector<Index> finite;
  for (Index i = 0; i < x.rows(); ++i) {
    if (x.row(i).allFinite()) finite.push_back(i);
  }
  if (std::ssize(finite) < fewest) return std::nullopt;
  if (std::ssize(finite) < x.rows()) x = x(finite, Eigen::all).eval();
  return inference::usual_features(x, tails);
}

}  // namespace npdr::pipeline
