#include <algorithm>
#include <cmath>

#include "inference/diagnostics/row_faults.h"

namespace npdr::inference {
namespace {

constexpr double kHardlyRepeats = 0.9;  // share of different values

// `values` sorted from the innermost on; one end of them.
std::optional<CodedColumn> code_at_the_end(const std::vector<float>& values) {
  constexpr Index fewest = 5, fewest_exact = 3, fewest_to_tell_modes = 200;
  constexpr double least = 0.002, most = 0.5, of_gap = 1.0 / 20.0, of_range = 0.5;
  const Index n = std::ssize(values);
  const auto at = [&](Index i) { return double{values[static_cast<std::size_t>(i)]}; };
  for (Index m = n - 1; m >= std::max<Index>(3, n - static_cast<Index>(most * double(n))); --m) {
    const double gap = std::abs(at(m) - at(m - 1)), range = std::abs(at(m - 1) - at(0));
    const double extent = std::abs(at(n - 1) - at(m));
    if (!(range > 0.0) || gap <= range || extent > of_gap * gap) continue;
    const Index count = n - m;
    const bool is_exact = !(extent > 0.0);
    // Of few rows a mode of its own may look narrow.
    if (extent > of_range * range || (!is_exact && n < fewest_to_tell_modes)) continue;
    Index unique = 0;
    for (Index i = 0; i < m; ++i) unique += i == 0 || at(i) != at(i - 1) ? 1 : 0;
    const bool repeats = static_cast<double>(unique) < kHardlyRepeats * static_cast<double>(m);
    const bool is_enough = is_exact && !repeats
                               ? count >= fewest_exact
                               : count >= fewest && double(count) >= least * double(n);
    if (is_enough) return CodedColumn{0, values.back(), count, is_exact};
  }
  return std::nullopt;
}

}  // namespace

std::vector<CodedColumn> find_codes(const RowMatrixF& x) {
  std::vector<CodedColumn> found;
  for (Index c = 0; c < x.cols(); ++c) {
    std::vector<float> values;
    for (const float value : x.col(c)) {
      if (std::isfinite(value)) values.push_back(value);
    }
    std::ranges::sort(values);
    std::optional<CodedColumn> code = code_at_the_end(values);
    if (!code) {
      std::ranges::reverse(values);
      code = code_at_the_end(values);
    }
    if (!code) continue;
    code->column = c;
    found.push_back(*code);
  }
  return found;
}

}  // namespace npdr::inference
