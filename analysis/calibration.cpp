#include "analysis/calibration.h"

#include <string>
#include <unsupported/Eigen/SpecialFunctions>

#include "core/error.h"

namespace npdr::analysis {

std::vector<Index> ranks(const RowMatrix& samples, const Vector& truth) {
  if (samples.cols() != truth.size()) {
    throw ShapeError("ranks: samples of " + std::to_string(samples.cols()) +
                     " parameters, a truth of " + std::to_string(truth.size()));
  }
  std::vector<Index> result;
  for (Index d = 0; d < truth.size(); ++d) {
    result.push_back((samples.col(d).array() < truth(d)).count());
  }
  return result;
}

UniformityTest test_uniform_ranks(const std::vector<Index>& ranks, Index num_samples,
                                  Index num_bins) {
  if (ranks.empty()) throw InputError("test_uniform_ranks: no ranks");
  if (num_bins < 2 || (num_samples + 1) % num_bins != 0) {
    throw InputError("test_uniform_ranks: " + std::to_string(num_bins) +
                     " bins, must be at least 2 and divide the " + std::to_string(num_samples + 1) +
                     " possible ranks");
  }
  UniformityTest test;
  test.counts.assign(static_cast<std::size_t>(num_bins), 0);
  const Index width = (num_samples + 1) / num_bins;
  for (const Index rank : ranks) {
    if (rank < 0 || rank > num_samples) {
      throw InputError("test_uniform_ranks: rank " + std::to_string(rank) + ", must be 0 to " +
                       std::to_string(num_samples));
    }
    ++test.counts[static_cast<std::size_t>(rank / width)];
  }
  const double expected = static_cast<double>(ranks.size()) / static_cast<double>(num_bins);
  for (const Index count : test.counts) {
    const double gap = static_cast<double>(count) - expected;
    test.chi_square += gap * gap / expected;
  }
  test.p_value =
      Eigen::numext::igammac(0.5 * static_cast<double>(num_bins - 1), 0.5 * test.chi_square);
  return test;
}

}  // namespace npdr::analysis
