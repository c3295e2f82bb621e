#include "pipeline/import/rate_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "analysis/scatter.h"
#include "core/constants.h"
#include "core/quantile.h"
#include "sim/savitzky_golay.h"

namespace npdr::pipeline {
namespace {

constexpr std::array<Index, 7> kWindows = {3, 5, 11, 21, 51, 101, 201};
constexpr Index kFewestWindows = 10;  // of a length, that fit into a rollout side by side
// The 90 % quantile of white noise is 1.6 of its standard deviation: 5 of them aren't noise.
constexpr double kStandsOut = 5.0;
// Drift of a rate without noise of its own, while nothing moves.
constexpr double kStandsOutAlone = 20.0;
constexpr double kTolerance = 0.15;
// Differences to the sample before are short of a swing's rates by (omega dt)^2 / 8: twice that.
constexpr double kBendShare = 0.25;
constexpr double kLeapStandsOut = 30.0;  // of the median size: 20 standard deviations of noise
constexpr double kFewestCounts = 4.0;    // of an encoder, that are a leap
constexpr double kLargestScatter = 0.5;
// Samples by which filtered rates usually lag: they count where a rollout has few.
constexpr double kUsualLag = 10.0;

double median(auto values) { return quantile(std::move(values), 0.5, Between::lower); }

double size_of(const Vector& values) {
  return quantile(Vector(values.cwiseAbs()), 0.9, Between::lower);
}

// The same about the median.
double spread_of(const Vector& values) { return size_of(values.array() - median(values)); }

// In most of its steps, as the speed in counts that a slow servo tells.
bool stands_still(const Vector& rate) {
  constexpr double rounding = 1e-6;
  return median(Vector(differences(rate).cwiseAbs())) <= rounding * size_of(rate);
}

// Slopes of the positions, and averages of the rates that belong to them, of every whole window.
struct Slopes {
  Vector of_position, of_rate;
  double noise;     // standard deviation that noise gives them, the larger of both
  bool are_coarse;  // rates that stay the same in most of their steps
};

Slopes slopes_over(const Vector& position, const Vector& rate, Index window, double dt) {
  const sim::SavitzkyGolay line = sim::savitzky_golay(window, 1, dt);
  const Vector weights = line.step_average(dt);
  const Index count = position.size() - window + 1;
  Slopes slopes{Vector(count), Vector(count), 0.0, stands_still(rate)};
  const Vector held = 0.5 * (rate.head(rate.size() - 1) + rate.tail(rate.size() - 1));
  for (Index t = 0; t < count; ++t) {
    slopes.of_position(t) = line.slope.dot(position.segment(t, window));
    slopes.of_rate(t) = weights.dot(held.segment(t, window - 1));
  }
  const double rounding = std::numeric_limits<double>::epsilon() * position.cwiseAbs().maxCoeff();
  const double of_position = std::max(analysis::scatter(position), rounding);
  slopes.noise =
      std::max(of_position * line.slope.norm(), analysis::scatter(rate) * weights.norm());
  return slopes;
}

RateFit fit_of(const Slopes& slopes, Index window) {
  const double slack = kUsualLag / static_cast<double>(slopes.of_rate.size() + window - 1);
  const double large = 0.5 * size_of(slopes.of_rate);
  std::vector<double> ratios;
  for (Index t = 0; t < slopes.of_rate.size(); ++t) {
    if (std::abs(slopes.of_rate(t)) < large || slopes.of_rate(t) == 0.0) continue;
    ratios.push_back(slopes.of_position(t) / slopes.of_rate(t));
  }
  if (ratios.empty()) return {window, 0.0, kInfinity, slack};
  const double bend = size_of(differences(differences(slopes.of_rate)));
  const double blur = slopes.are_coarse ? kInfinity : kBendShare * bend / size_of(slopes.of_rate);
  const double ratio = median(ratios);
  std::ranges::transform(ratios, ratios.begin(), [&](double r) { return std::abs(r - ratio); });
  const double scatter = ratio == 0.0 ? kInfinity : median(ratios) / std::abs(ratio);
  return {window, ratio, scatter, slack, blur};
}

// Whether both move, or one of them so much that the other should.
bool is_telling(const Slopes& slopes) {
  const auto moves = [&](const Vector& values) {
    return size_of(values) > kStandsOut * slopes.noise;
  };
  if (moves(slopes.of_position) && moves(slopes.of_rate)) return true;
  return std::max(spread_of(slopes.of_position), spread_of(slopes.of_rate)) >
         kStandsOutAlone * slopes.noise;
}

}  // namespace

std::optional<RateFit> fit_rate(const Vector& position, const Vector& rate, double dt) {
  std::optional<RateFit> best;
  if (position.size() < kFewestSamples) return best;
  for (const Index window : kWindows) {
    if (kFewestWindows * window > position.size()) break;
    const Slopes slopes = slopes_over(position, rate, window, dt);
    if (!is_telling(slopes)) continue;
    const RateFit fit = fit_of(slopes, window);
    if (!best || fit.scatter < best->scatter) best = fit;
  }
  return best;
}

std::vector<Index> find_leaps(const Vector& position, const Vector& rate, double dt) {
  const Index n = position.size() - 1;
  if (position.size() < kFewestSamples) return {};
  const Vector steps = differences(position);
  Vector left = steps - 0.5 * dt * (rate.head(n) + rate.tail(n));
  left.array() -= median(left);
  const Vector size = left.cwiseAbs();
  const double range = position.maxCoeff() - position.minCoeff();
  const double least = std::max({0.25 * range, kLeapStandsOut * median(Vector(left.cwiseAbs())),
                                 kFewestCounts * analysis::smallest_step(position)});
  std::vector<Index> leaps;
  for (Index t = 0; t < n; ++t) {
    if (!(size(t) > least)) continue;
    // Rates that lag behind, or that are known too roughly, miss some of many steps on end; a
    // single sample that is off is a glitch.
    const double beside = std::max(t > 0 ? size(t - 1) : 0.0, t + 1 < n ? size(t + 1) : 0.0);
    if (beside < 0.25 * size(t)) leaps.push_back(t);
  }
  return leaps;
}

RateVerdict verdict_of(const RateFit& fit) {
  const double size = std::abs(fit.ratio);
  const bool is_one = std::max(size, 1.0 / size) <= 1.0 + kTolerance + fit.scatter + fit.slack;
  if (fit.scatter > kLargestScatter + fit.slack) return RateVerdict::unrelated;
  if (fit.ratio < 0.0) return is_one ? RateVerdict::scaled : RateVerdict::unrelated;
  return is_one ? RateVerdict::agrees : RateVerdict::scaled;
}

}  // namespace npdr::pipeline
