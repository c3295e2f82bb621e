#include "inference/diagnostics/levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <ranges>
#include <unsupported/Eigen/SpecialFunctions>
#include <vector>

#include "core/normal.h"
#include "inference/diagnostics/uniformity.h"

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

// A level among all, and F of its value.
struct Placed {
  double below = 0.0, up_to = 0.0, f = 0.0;  // shares

  // How far F lies from the shares, with its sign; 0: within.
  double outside() const { return f < below ? f - below : std::max(f - up_to, 0.0); }
};

std::vector<Placed> placed(const Levels& levels, const Marginal& marginal) {
  RowMatrix values(std::ssize(levels), 1);
  std::ranges::copy(std::views::keys(levels), values.data());
  const RowMatrix u = Prior({marginal}).to_normal(values);
  double total = 0.0, below = 0.0;
  for (const auto& [value, count] : levels) total += static_cast<double>(count);
  std::vector<Placed> all;
  for (const auto& [value, count] : levels) {
    const double up_to = below + static_cast<double>(count);
    all.push_back({below / total, up_to / total, normal_cdf(u(std::ssize(all), 0))});
    below = up_to;
  }
  return all;
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
  double largest = 0.0;
  for (const Placed& level : placed(levels, marginal)) {
    largest = std::max(largest, std::abs(level.outside()));
  }
  return largest;
}

double p_value_of_levels(const Levels& levels, const Marginal& marginal, Index num_draws) {
  constexpr double end = 1e-12;
  const auto n = static_cast<double>(num_draws);
  std::vector<double> f;
  for (const Placed& level : placed(levels, marginal)) {
    const double share = level.up_to - level.below;
    const Index count = std::max<Index>(1, std::lround(share * n));
    for (Index k = 0; k < count; ++k) {
      const double rank = (static_cast<double>(k) + 0.5) / static_cast<double>(count);
      f.push_back(std::clamp(level.below + rank * share + level.outside(), end, 1.0 - end));
    }
  }
  const Vector values = Vector::Map(f.data(), std::ssize(f));
  const double squares = n * values.unaryExpr(&normal_quantile).array().square().mean();
  const double above = Eigen::numext::igammac(0.5 * n, 0.5 * squares);
  const double of_width = 2.0 * std::min(above, 1.0 - above);
  const double statistic = anderson_darling(values) * n / static_cast<double>(f.size());
  return corrected(std::min(of_width, anderson_darling_p_value(statistic)), 2);
}

}  // namespace npdr::inference
