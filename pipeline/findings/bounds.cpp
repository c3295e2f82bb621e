// Pressure of samples against the ends of the prior.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/normal.h"
#include "inference/diagnostics/bound_pressure.h"
#include "pipeline/findings/findings.h"
#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

// The atomic loss compares densities at parameters that were simulated, and sees no others.
bool may_leak(const MethodConfig& method) {
  const inference::AlgorithmConfig& algorithm = method.algorithm;
  return algorithm.kind == inference::Algorithm::npe_c && algorithm.num_rounds > 1 &&
         !algorithm.combined_loss &&
         !inference::is_analytic(algorithm, method.density_estimator.kind);
}

// Whether nothing lies beyond an end: the study says so, or the simulator's own limit is as near as
// the test tells values apart. 0 is no end of a parameter over decades, and limits of an angle are
// none: beyond lies its other end.
bool is_physical(const PressedBound& bound, const inference::Marginal& marginal,
                 const sim::Parameter& parameter) {
  using enum inference::PhysicalEnds;
  if (marginal.physical == both || marginal.physical == (bound.is_lower ? lower : upper)) {
    return true;
  }
  if (parameter.period > 0.0) return false;
  const auto place = [&](double value) { return marginal.is_log() ? std::log(value) : value; };
  const double limit = bound.is_lower ? parameter.lower : parameter.upper;
  return std::abs(place(bound.value) - place(limit)) <=
         inference::BoundPressure::kGap * (place(marginal.upper()) - place(marginal.lower()));
}

// `share`: of samples, the largest at any end. Where that is small, samples all lie near the end,
// or leak there.
std::string share_at_end(double share) {
  using inference::BoundPressure;
  if (share <= BoundPressure::kPressingShare) return "all samples lie close to that end";
  return fmt::format("{:.0f} % of the samples lie there (fine up to {:.0f} %)", 100.0 * share,
                     100.0 * BoundPressure::kPressingShare);
}

}  // namespace

std::vector<PressedBound> pressed_bounds(const inference::Marginal& marginal,
                                         const Vector& samples) {
  if (!marginal.is_uniform()) return {};
  const Vector v = inference::Prior({marginal}).to_normal(samples).col(0).unaryExpr(&normal_cdf);
  const inference::BoundPressure found = inference::test_bounds(v);
  std::vector<PressedBound> pressed;
  if (found.presses_lower()) {
    pressed.push_back({marginal.lower(), true, found.leaks_lower(), found.lower});
  }
  if (found.presses_upper()) {
    pressed.push_back({marginal.upper(), false, found.leaks_upper(), found.upper});
  }
  return pressed;
}

template <>
Findings judge<Check::bounds>(const MethodResults& m) {
  if (m.has_too_few_samples()) return {too_few_samples(m.runs.front()->evaluation.theta.rows())};
  std::vector<std::string> faults, physical;
  std::set<const EvaluatedRun*> failed;
  bool leaks = false;
  double share = 0.0;
  for (const Index d : m.inferred()) {
    const inference::Marginal& marginal = m.data.marginal(d);
    const double period = m.data.period_of(d);
    // Of an angle over all of its period both ends may hold samples.
    if (period > 0.0 && marginal.b - marginal.a >= 0.999 * period) continue;
    std::map<double, bool> bounds;  // of all seeds, and whether they are faults
    for (const EvaluatedRun* run : m.runs) {
      for (const PressedBound& bound : pressed_bounds(marginal, run->evaluation.theta.col(d))) {
        const bool has_leaked = bound.leaks && may_leak(m.method);
        const bool is_fault = has_leaked || !is_physical(bound, marginal, m.data.parameter(d));
        bounds[bound.value] |= is_fault;
        leaks |= has_leaked;
        share = std::max(share, bound.share);
        if (is_fault) failed.insert(run);
      }
    }
    for (const auto& [bound, is_fault] : bounds) {
      const std::string unit = marginal.unit == "1" ? "" : " " + marginal.unit;
      (is_fault ? faults : physical)
          .push_back(fmt::format("{} = {:.4g}{}", marginal.name, bound, unit));
    }
  }
  if (!faults.empty()) {
    return {fails(
        {.what = "samples gather at an end of the prior, " + listed(faults),
         .evidence = share_at_end(share) + seeds_text(std::ssize(failed), m.runs.size()),
         .advice = leaks ? "Set combined_loss = true in [[method]]" : "Widen the prior there"})};
  }
  if (physical.empty()) return {passes({})};
  return {
      passes({.what = "samples gather at a physical limit, which may be right, " + listed(physical),
              .evidence = share_at_end(share)})};
}

}  // namespace npdr::pipeline
