// How far what a posterior's samples predict is from the observation.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/quantile.h"
#include "inference/diagnostics/bound_pressure.h"
#include "pipeline/features/observation.h"
#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

// The recorded states are at most 1 in its units, and 0 explains a swing with less. Where a model
// is right the floor is what noise leaves.
constexpr double kFarFloor = 0.5;

// What a posterior's RMSE is compared with: what the best of the prior reaches, or the truth, or
// the noise, below which the observation hardly tells parameters apart.
// Without noise the truth reaches zero, which no sample does: there a tenth of the prior's is small
// enough.
struct Yardstick {
  double limit = 0.0;
  double unit = 0.0;
  std::string words = {};

  /// "RMSE 30 times that of the best parameters (fine up to 3)", "RMSE 20 % of the prior's (fine up
  /// to 10)"
  std::string text_of(double rmse) const {
    return fmt::format("RMSE {} {} (fine up to {})", short_number(rmse / unit), words,
                       short_number(limit / unit));
  }
};

double median_of(const Vector& values) { return quantile_of_sorted(sorted_finite(values), 0.5); }

// What noise of a known scale leaves of the observation at the truth, in RMSE's unit; 0 without it.
double known_noise(const ReportData& data) {
  const ObservationNoise& stated = data.plan.study.observation_noise;
  if (stated.scale_prior || !(stated.scale > 0.0 || stated.std)) return 0.0;
  return noise_model(data.plan.study, data.target).relative_size().mean();
}

std::optional<Yardstick> yardstick(const ReportData& data) {
  const std::string rmse = name_of(Metric::rmse);
  const double of_prior = median_of(data.baseline.prior->metrics.at(rmse));
  Yardstick found;
  if (of_prior > 0.0) found = {0.1 * of_prior, 0.01 * of_prior, "% of the prior's"};
  for (const BaselinePoint& point : data.baseline.points) {
    if (point.name != "floor" && point.name != "truth") continue;
    const double reached = point.metrics.at(rmse);
    if (3.0 * reached > found.limit) {
      found = {3.0 * reached, reached,
               point.name == "truth" ? "times the truth's" : "times that of the best parameters"};
    }
  }
  const double noise = std::min(known_noise(data), kFarFloor);
  if (noise > found.limit) found = {noise, noise, "times the noise"};
  if (found.limit > 0.0) return found;
  return std::nullopt;
}

// Samples that explain the observation no better than half of the prior's, where the rest does far
// better, belong to a mode that isn't there.
constexpr double kFarBetter = 3.0;
constexpr double kMostStrays = 0.1;

// Their share of the samples whose rollouts succeeded; 0 where the rest isn't far better, and where
// there are too few to tell.
double share_of_strays(const Vector& rmse, double of_prior) {
  const Index count = rmse.array().isFinite().count();
  if (count < inference::kFewestForBounds || !(of_prior > kFarBetter * median_of(rmse))) return 0.0;
  const Index strays = (rmse.array().isFinite() && rmse.array() > of_prior).count();
  return static_cast<double>(strays) / static_cast<double>(count);
}

// The smallest RMSE of any parameters of the prior; 0 where it wasn't looked for.
double floor_of(const ReportData& data) {
  for (const BaselinePoint& point : data.baseline.points) {
    if (point.name == "floor") return point.metrics.at(name_of(Metric::rmse));
  }
  return 0.0;
}

// Networks leave what more simulations near the recording would find.
Findings room_to_learn(const MethodResults& m, double rmse, double of_floor) {
  constexpr double more = 2.0;
  if (!m.study.target.recording || m.is(inference::Algorithm::refine) || of_floor == 0.0 ||
      rmse < more * of_floor) {
    return {};
  }
  return {passes({.id = "room",
                  .what = "the samples could be nearer to the recording",
                  .evidence = fmt::format("RMSE {:.2g} times that of the best parameters (good "
                                          "below {:.0f})",
                                          rmse / of_floor, more),
                  .advice = advice_to_refine(m)})};
}

// Of the seed that is worst.
struct FitOfSamples {
  Index failed = 0, astray = 0;  ///< seeds
  double rmse = 0.0;             ///< median; NaN where no rollout succeeded
  double strays = 0.0;           ///< share_of_strays()
};

FitOfSamples fit_of(const MethodResults& m, double limit) {
  const double of_prior = median_of(m.data.baseline.prior->metrics.at(name_of(Metric::rmse)));
  FitOfSamples worst;
  for (const EvaluatedRun* run : m.runs) {
    const Vector& its = run->evaluation.metrics.at(name_of(Metric::rmse));
    const double median = median_of(its);
    if (std::isnan(median)) return {.rmse = median};
    worst.failed += median > limit ? 1 : 0;
    worst.rmse = std::max(worst.rmse, median);
    const double share = share_of_strays(its, of_prior);
    worst.astray += share > kMostStrays ? 1 : 0;
    worst.strays = std::max(worst.strays, share);
  }
  return worst;
}

}  // namespace

template <>
Findings judge<Check::fit>(const MethodResults& m) {
  const double of_floor = floor_of(m.data);
  if (const auto cause = words_of_cause(m.data)) return {fails(*cause)};
  if (of_floor > kFarFloor) {
    return {fails({.id = "floor",
                   .what = "no parameters of the prior explain the observation",
                   .evidence = fmt::format("RMSE {:.2g} of its largest magnitude at best (fine up "
                                           "to {:.2g})",
                                           of_floor, kFarFloor),
                   .advice = "Check units, clock, signs and zeros of the observation"})};
  }
  if (m.data.baseline.misfit && m.data.baseline.misfit->is_beyond()) {
    return {fails(words_of_misfit(m.data))};
  }
  const std::optional<Yardstick> reached = yardstick(m.data);
  const FitOfSamples worst = fit_of(m, reached ? reached->limit : 0.0);
  if (!reached || std::isnan(worst.rmse)) {
    return {cannot_tell({.what = "no rollout succeeded that could be compared with the observation",
                         .advice = "Read why in the log of stage evaluate"})};
  }
  const std::string size = reached->text_of(worst.rmse);
  const std::string advice = advice_on_noise(m.study, advice_to_learn(m));
  if (worst.failed > 0) {
    return {fails({.id = "far",
                   .what = "simulations of the samples miss the observation",
                   .evidence = size + seeds_text(worst.failed, m.runs.size()),
                   .advice = advice})};
  }
  if (worst.astray > 0) {
    return {fails(
        {.id = "strays",
         .what = "some samples are far off, in a false second peak",
         .evidence = fmt::format(
             "{:.0f} % of them fit worse than a typical draw of the prior (fine "
             "up to {:.0f} %){}",
             100.0 * worst.strays, 100.0 * kMostStrays, seeds_text(worst.astray, m.runs.size())),
         .advice = advice})};
  }
  Findings found = {passes({.evidence = size})};
  append(found, room_to_learn(m, worst.rmse, of_floor));
  return found;
}

}  // namespace npdr::pipeline
