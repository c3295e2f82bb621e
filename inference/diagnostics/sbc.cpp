#include "inference/diagnostics/sbc.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>

#include "core/error.h"
#include "core/random.h"

namespace npdr::inference {
namespace {

// A number in 0, ..., ties, of a stream that the samples seed.
Index place_among(Index ties, const Vector& samples) {
  std::uint64_t seed = 0;
  for (const double value : samples) {
    seed = std::rotl(seed, 7) * 0x9e3779b97f4a7c15U + std::bit_cast<std::uint64_t>(value);
  }
  Stream stream({seed, "rank_among_ties", 0, 0, 0});
  return static_cast<Index>(stream.below(static_cast<std::uint32_t>(ties) + 1));
}

}  // namespace

std::vector<Index> ranks(const RowMatrix& samples, const Vector& truth) {
  if (samples.cols() != truth.size()) {
    throw ShapeError("ranks: samples of " + std::to_string(samples.cols()) +
                     " parameters, a truth of " + std::to_string(truth.size()));
  }
  std::vector<Index> result;
  for (Index d = 0; d < truth.size(); ++d) {
    const auto of_parameter = samples.col(d).array();
    const Index smaller = (of_parameter < truth(d)).count();
    const Index ties = (of_parameter == truth(d)).count();
    result.push_back(smaller + (ties == 0 ? 0 : place_among(ties, samples.col(d))));
  }
  return result;
}

Sbc test_sbc(const RowMatrix& spread) {
  constexpr Index most_bins = 20, fewest_in_bin = 15;  // ranks that are expected
  const Index num_bins = std::clamp(spread.rows() / fewest_in_bin, Index{2}, most_bins);
  Sbc sbc;
  sbc.parameter_p_value.resize(spread.cols());
  for (Index d = 0; d < spread.cols(); ++d) {
    sbc.kolmogorov_smirnov.push_back(test_kolmogorov_smirnov(spread.col(d)));
    sbc.chi_square.push_back(test_chi_square(spread.col(d), num_bins));
    sbc.parameter_p_value(d) = corrected(
        std::min(sbc.kolmogorov_smirnov.back().p_value, sbc.chi_square.back().p_value), 2);
  }
  sbc.p_value = corrected(sbc.parameter_p_value.minCoeff(), spread.cols());
  return sbc;
}

}  // namespace npdr::inference
