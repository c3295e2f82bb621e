// Ends of the prior that samples press against.
#include <fmt/format.h>

#include <set>

#include "core/normal.h"
#include "core/text.h"
#include "inference/diagnostics/bound_pressure.h"
#include "pipeline/findings/findings.h"
#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

// Of an angle over all of its period both ends may hold samples.
bool is_whole_period(const inference::Marginal& marginal, double period) {
  return period > 0.0 && marginal.b - marginal.a >= 0.999 * period;
}

// The atomic loss compares densities at parameters that were simulated, and sees no others.
bool may_leak(const MethodConfig& method) {
  const inference::AlgorithmConfig& algorithm = method.algorithm;
  return algorithm.kind == inference::Algorithm::npe_c && algorithm.num_rounds > 1 &&
         !algorithm.combined_loss &&
         !inference::is_analytic(algorithm, method.density_estimator.kind);
}

}  // namespace

std::vector<PressedBound> pressed_bounds(const inference::Marginal& marginal,
                                         const Vector& samples) {
  if (marginal.is_unbounded()) return {};
  const Vector v = inference::Prior({marginal}).to_normal(samples).col(0).unaryExpr(&normal_cdf);
  const inference::BoundPressure found = inference::test_bounds(v);
  std::vector<PressedBound> pressed;
  if (found.presses_lower()) pressed.push_back({marginal.lower(), found.leaks_lower()});
  if (found.presses_upper()) pressed.push_back({marginal.upper(), found.leaks_upper()});
  return pressed;
}

template <>
Finding judge<Check::bounds>(const MethodResults& m) {
  if (m.has_too_few_samples()) return too_few_samples(m.runs.front()->evaluation.theta.rows());
  std::vector<std::string> pressed;
  std::set<const EvaluatedRun*> failed;
  bool leaks = false;
  for (const Index d : m.inferred()) {
    const inference::Marginal& marginal = m.data.marginal(d);
    if (is_whole_period(marginal, m.data.period_of(d))) continue;
    std::set<double> bounds;  // of all seeds
    for (const EvaluatedRun* run : m.runs) {
      for (const PressedBound& bound : pressed_bounds(marginal, run->evaluation.theta.col(d))) {
        bounds.insert(bound.value);
        leaks |= bound.leaks;
        failed.insert(run);
      }
    }
    for (const double bound : bounds) {
      const std::string unit = marginal.unit == "1" ? "" : " " + marginal.unit;
      pressed.push_back(fmt::format("{} at {:.4g}{}", marginal.name, bound, unit));
    }
  }
  if (pressed.empty()) return passes("");
  return fails("PRESSES against them" + seeds_text(std::ssize(failed), m.runs.size()),
               fmt::format("its samples press against the end of the prior: {}; the prior may "
                           "exclude the truth: widen it, or look for what the simulator lacks{}",
                           join(pressed),
                           leaks && may_leak(m.method)
                               ? "; or its density has leaked there: try combined_loss = true"
                               : ""));
}

}  // namespace npdr::pipeline
