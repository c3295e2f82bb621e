#include "inference/diagnostics/levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <ranges>

#include "core/normal.h"

namespace npdr::inference {
namespace {

constexpr double kRounding = 1e-9;  // of the range
constexpr double kFilled = 0.5;     // share of a grid's places

template <class Map>
double filled(const Levels& levels, const Map& map) {
  if (levels.size() < 2) return 1.0;
  const double range = map(levels.rbegin()->first) - map(levels.begin()->first);
  double smallest = range;
  Index num_steps = 0;
  for (auto level = levels.begin(); std::next(level) != levels.end(); ++level) {
    const double step = map(std::next(level)->first) - map(level->first);
    if (!(step > kRounding * range)) continue;
    smallest = std::min(smallest, step);
    ++num_steps;
  }
  return static_cast<double>(num_steps) / std::max(range / smallest, 1.0);
}

}  // namespace

Levels levels_of(const Eigen::Ref<const Vector>& values) {
  Levels levels;
  for (const double value : values) ++levels[value];
  return levels;
}

double filled_by_steps(const Levels& levels) {
  return filled(levels, [](double value) { return value; });
}

double filled_by_factors(const Levels& levels) {
  if (!(levels.begin()->first > 0.0)) return 0.0;
  return filled(levels, [](double value) { return std::log(value); });
}

bool is_grid(const Levels& levels) {
  return std::max(filled_by_steps(levels), filled_by_factors(levels)) >= kFilled;
}

bool is_rounded(double value) {
  return std::strtod(fmt::format("{:.6g}", value).c_str(), nullptr) == value;
}

bool are_chosen(const Levels& levels) {
  return is_grid(levels) || std::ranges::all_of(std::views::keys(levels), is_rounded);
}

bool is_design(const Levels& levels) {
  if (std::ssize(levels) > kFewLevels) return false;
  Index count = 0;
  for (const Index of_level : std::views::values(levels)) count += of_level;
  return count >= 2 * std::ssize(levels) && are_chosen(levels);
}

double distance_of_levels(const Levels& levels, const Marginal& marginal) {
  RowMatrix values(std::ssize(levels), 1);
  std::ranges::copy(std::views::keys(levels), values.data());
  const RowMatrix u = Prior({marginal}).to_normal(values);
  double total = 0.0, below = 0.0, largest = 0.0;
  for (const auto& [value, count] : levels) total += static_cast<double>(count);
  Index next = 0;
  for (const auto& [value, count] : levels) {
    const double f = normal_cdf(u(next++, 0)), up_to = below + static_cast<double>(count);
    largest = std::max({largest, below / total - f, f - up_to / total});
    below = up_to;
  }
  return largest;
}

}  // namespace npdr::inference
