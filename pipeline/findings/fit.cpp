// How far what a posterior's samples predict is from the observation.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/quantile.h"
#include "core/text.h"
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
  double unit = 0.0;  ///< "30 times the floor's", "20 % of the prior's"
  std::string words;

  std::string text_of(double rmse) const { return short_number(rmse / unit) + " " + words; }
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
      found = {3.0 * reached, reached, "times the " + point.name + "'s"};
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

// White noise of a recording is what the best parameters leave of it, but for the little that they
// take away of so many numbers. The size of heavy tails may be that of a few numbers, which a
// recording needn't have.
std::string overstated_noise(const ReportData& data, double of_floor) {
  constexpr double far_more = 3.0;
  const Study& study = data.plan.study;
  const double noise = known_noise(data);
  const ObservationNoise& stated = study.observation_noise;
  if (!study.target.recording || stated.is_correlated() || stated.is_heavy_tailed() ||
      of_floor == 0.0 || noise < far_more * of_floor) {
    return "";
  }
  return fmt::format(
      "the best parameters leave {:.2g} of the recording, the noise is {:.0f} times as large: "
      "lower observation_noise, or posteriors say less than the recording does",
      of_floor, noise / of_floor);
}

// Networks leave what more simulations near the recording would find.
std::string room_to_learn(const MethodResults& m, double rmse, double of_floor) {
  constexpr double more = 2.0;
  if (!m.study.target.recording || m.is(inference::Algorithm::refine) || of_floor == 0.0 ||
      rmse < more * of_floor) {
    return "";
  }
  return fmt::format(
      "its samples are {:.2g} times as far from the recording as the best parameters: a method "
      "with algorithm = \"refine\" and refine.start = \"{}\" finds what is between",
      rmse / of_floor, m.method.name);
}

}  // namespace

template <>
Finding judge<Check::fit>(const MethodResults& m) {
  const double of_floor = floor_of(m.data);
  if (of_floor > kFarFloor) {
    return fails(fmt::format("NO parameters fit, {:.2g} at best", of_floor),
                 fmt::format("the smallest RMSE of any parameters of the prior is {:.2g} of the "
                             "largest recorded magnitude: look at units, clock, and sign and zero "
                             "of the angles of the recording, or widen the prior",
                             of_floor));
  }
  const std::optional<Yardstick> reached = yardstick(m.data);
  const double of_prior = median_of(m.data.baseline.prior->metrics.at(name_of(Metric::rmse)));
  Index failed = 0, astray = 0;
  double worst = 0.0, strays = 0.0;
  for (const EvaluatedRun* run : m.runs) {
    const Vector& its = run->evaluation.metrics.at(name_of(Metric::rmse));
    const double median = median_of(its);
    if (!reached || std::isnan(median)) {
      return cannot_tell("no rollout succeeded that an RMSE could be measured of");
    }
    failed += median > reached->limit ? 1 : 0;
    worst = std::max(worst, median);
    const double share = share_of_strays(its, of_prior);
    astray += share > kMostStrays ? 1 : 0;
    strays = std::max(strays, share);
  }
  const std::string size = reached->text_of(worst);
  const std::string advice =
      (is_noise_unstated(m.study) ? "observation_noise.scale, which the study doesn't state, "
                                  : "") +
      advice_to_learn(m.method);
  if (failed > 0) {
    return fails(
        "FAR above what can be reached" + seeds_text(failed, m.runs.size()) + ", " + size,
        fmt::format("{:.3g} is the median RMSE of its samples, {}: try {}", worst, size, advice));
  }
  if (astray > 0) {
    return fails(
        fmt::format("{:.0f} % of its samples are FAR off{}", 100.0 * strays,
                    seeds_text(astray, m.runs.size())),
        fmt::format("their RMSE is above {:.3g}, the median of the prior's; that of all of them "
                    "is {:.3g}: a mode that isn't there; try {}, or a refinement of its posterior",
                    of_prior, worst, advice));
  }
  if (m.data.baseline.misfit && m.data.baseline.misfit->is_beyond()) {
    return fails(short_number(m.data.baseline.misfit->times) + " times the noise is LEFT",
                 words_of_misfit(m.data));
  }
  std::vector<std::string> remarks = {overstated_noise(m.data, of_floor),
                                      room_to_learn(m, worst, of_floor)};
  std::erase(remarks, "");
  return passes(size, join(remarks, "; "));
}

}  // namespace npdr::pipeline
