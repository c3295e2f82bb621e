#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/curve_plot.h"
#include "core/text.h"
#include "pipeline/report/figure_parts.h"
#include "pipeline/report/registry.h"

namespace npdr::pipeline {
namespace {

bool has_powers(const EvaluatedRun& run) { return run.notes.powers.power.size() > 0; }

// The drawn methods that chose a power, as far as their first seed tells.
std::vector<std::string> methods_with_powers(const ReportData& data) {
  std::vector<std::string> methods = drawn_methods(data.methods);
  std::erase_if(methods,
                [&](const auto& method) { return !has_powers(*data.runs_of(method).front()); });
  return methods;
}

// Means over rollouts, with a standard error to either side.
analysis::Curve curve_of(const std::string& method, const PowerScores& scores) {
  const Vector mean = scores.crps.rowwise().mean();
  Vector error(mean.size());
  for (Index i = 0; i < error.size(); ++i) error(i) = scores.standard_error(i);
  return {method, scores.power.array().log10(), mean, mean - error, mean + error};
}

}  // namespace

/// Scores of the powers of the likelihood that refinements chose from, of the first seed.
std::optional<ReportedFigure> power_figure(const ReportData& data) {
  const std::vector<std::string> methods = methods_with_powers(data);
  if (methods.empty()) return std::nullopt;
  analysis::CurvePlot plot{"powers", "log10 of the power", "CRPS with noise", {}};
  std::vector<std::string> taken;
  for (const std::string& method : methods) {
    const PosteriorNotes& notes = data.runs_of(method).front()->notes;
    plot.curves.push_back(curve_of(method, notes.powers));
    const double chosen = notes.certificate->wanted_power;
    taken.push_back(fmt::format("{:.3g} ({}{})", chosen, method,
                                chosen <= notes.powers.power(0) ? ", none smaller was tried" : ""));
  }
  return {
      {figure_of(plot),
       fmt::format(
           "How well the posterior without a rollout predicts that rollout, by the power of the "
           "likelihood: mean over the rollouts that inference sees, and its standard error, "
           "seed {}. Chosen was the smallest power that is about as good as any: {}.",
           data.seeds.front(), join(taken))}};
}

}  // namespace npdr::pipeline
