#include "pipeline/report/figure_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "analysis/interval_plot.h"
#include "analysis/pair_plot.h"
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

std::vector<Index> shown_parameters(const Study& study) {
  std::vector<Index> shown;
  if (study.report.parameters.empty()) {
    shown.resize(std::min<std::size_t>(study.prior.size(), analysis::kMaxPairParameters));
    std::iota(shown.begin(), shown.end(), Index{0});
  }
  for (const std::string& name : study.report.parameters) {
    const auto found = std::ranges::find(study.prior, name, &inference::Marginal::name);
    shown.push_back(found - study.prior.begin());
  }
  return shown;
}

std::string left_out_parameters(const Study& study) {
  const std::size_t shown = shown_parameters(study).size();
  if (shown == study.prior.size()) return "";
  return fmt::format(" {} of {} parameters.", shown, study.prior.size());
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
