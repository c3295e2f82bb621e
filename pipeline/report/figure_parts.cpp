#include "pipeline/report/figure_parts.h"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/interval_plot.h"
#include "core/quantile.h"

namespace npdr::pipeline {

std::vector<std::string> drawn_methods(std::vector<std::string> methods) {
  methods.resize(std::min(methods.size(), analysis::kMaxMethods));
  return methods;
}

std::string left_out_methods(const std::vector<std::string>& methods) {
  const std::size_t drawn = drawn_methods(methods).size();
  if (drawn == methods.size()) return "";
  return fmt::format(" The first {} of {} methods.", drawn, methods.size());
}

RowMatrix interval_quantiles(const RowMatrix& samples) {
  RowMatrix quantiles(samples.cols(), std::ssize(analysis::kIntervalLevels));
  for (Index d = 0; d < samples.cols(); ++d) {
    const std::vector<double> sorted = sorted_finite(samples.col(d));
    Index k = 0;
    for (const double level : analysis::kIntervalLevels) {
      quantiles(d, k++) = quantile_of_sorted(sorted, level);
    }
  }
  return quantiles;
}

}  // namespace npdr::pipeline
