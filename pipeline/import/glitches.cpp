#include "pipeline/import/glitches.h"

#include <algorithm>
#include <cmath>

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

}  // namespace npdr::pipeline
