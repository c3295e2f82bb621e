#include "pipeline/import/glitches.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/constants.h"

namespace npdr::pipeline {
namespace {

double usual_range(Vector values) {
  std::sort(values.begin(), values.end());
  const Index outer = std::max<Index>(values.size() / 100, 1);
  return values(values.size() - 1 - outer) - values(outer);
}

}  // namespace

std::vector<Index> find_glitches(const Vector& values) {
  constexpr Index fewest = 10;
  constexpr double far = 2.0, near = 0.25;
  std::vector<Index> glitches;
  if (values.size() < fewest) return glitches;
  const double range = usual_range(values);
  if (!(range > 0.0)) return glitches;
  for (Index t = 1; t + 1 < values.size(); ++t) {
    const double before = values(t - 1), after = values(t + 1);
    const double distance = std::abs(values(t) - 0.5 * (before + after));
    if (distance > far * range && std::abs(after - before) < near * distance) glitches.push_back(t);
  }
  return glitches;
}

std::vector<Index> find_lone_steps(const Vector& position) {
  constexpr Index fewest = 30;
  constexpr double larger = 4.0, share = 0.02;
  const Index n = position.size() - 1;
  if (n + 1 < fewest) return {};
  const Vector steps = position.tail(n) - position.head(n);
  Vector sorted = steps.cwiseAbs();
  std::sort(sorted.begin(), sorted.end(), std::greater());
  double least = kInfinity;
  for (Index k = 1; k <= std::max<Index>(n / 100, 3); ++k) {
    if (sorted(k) > 0.0 && sorted(k - 1) > larger * sorted(k)) least = sorted(k - 1);
  }
  least = std::max(least, share * (position.maxCoeff() - position.minCoeff()));
  // Several steps on end in one direction are a short motion.
  const auto goes_on = [&](Index t, Index beside) {
    return beside >= 0 && beside < n && larger * steps(beside) / steps(t) > 1.0;
  };
  std::vector<Index> lone;
  for (Index t = 0; t < n; ++t) {
    const bool is_large = std::abs(steps(t)) >= least;
    if (is_large && !goes_on(t, t - 1) && !goes_on(t, t + 1)) lone.push_back(t);
  }
  return lone;
}

}  // namespace npdr::pipeline
