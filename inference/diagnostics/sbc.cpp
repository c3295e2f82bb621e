#include "inference/diagnostics/sbc.h"

#include <algorithm>
#include <string>

#include "core/error.h"

namespace npdr::inference {

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

Sbc test_sbc(const RowMatrix& spread) {
  constexpr Index most_bins = 20, fewest_in_bin = 15;
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
