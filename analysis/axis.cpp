#include "analysis/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"

namespace npdr::analysis {
namespace {

constexpr int kMostDecades = 4;  // that the steps of an axis are shorter than it

// "10⁻³".
std::string power_of_ten(int exponent) {
  constexpr std::array<const char*, 10> digits = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "10⁻" : "10";
  for (const char c : std::to_string(std::abs(exponent))) {
    text += digits[static_cast<std::size_t>(c - '0')];
  }
  return text;
}

// Multiples of `step` in [lower, upper]. The ends may lie on a multiple but for rounding. None
// where doubles don't tell them apart.
std::vector<double> multiples(double lower, double upper, double step) {
  constexpr double slack = 1e-9;
  constexpr double most = 1000.0;
  const double first = std::ceil(lower / step - slack), last = std::floor(upper / step + slack);
  std::vector<double> values;
  if (!(last - first < most) || first + 1.0 == first) return values;
  for (double k = first; k <= last; k += 1.0) values.push_back(k * step);
  return values;
}

// The power of ten that values up to `size` are shown without; 0: they are short as they are. A
// double holds its inverse, too.
int shown_exponent(double size) {
  constexpr int most = 300;
  const int exponent = std::clamp(static_cast<int>(std::floor(std::log10(size))), -most, most);
  return exponent < -1 || exponent > 3 ? exponent : 0;
}

// "[10⁻³ kg]", with the power of ten that the shown values are to be multiplied by.
std::string unit_text(int exponent, const std::string& unit) {
  const std::string symbol = unit == "1" ? "" : unit;
  std::string text = exponent != 0 ? power_of_ten(exponent) : "";
  if (!text.empty() && !symbol.empty()) text += ' ';
  text += symbol;
  return text.empty() ? "" : "[" + text + "]";
}

}  // namespace

void Range::add(double value) {
  if (!std::isfinite(value)) return;
  lower = std::min(lower, value);
  upper = std::max(upper, value);
}

void Range::add(const Eigen::Ref<const Vector>& values) {
  for (const double v : values) add(v);
}

double Range::length() const {
  return upper > lower ? upper - lower : std::max(1e-3, std::abs(upper));
}

Range Range::widened(double margin) const {
  if (lower > upper) return {0.0, 1.0};
  return {lower - margin * length(), upper + margin * length()};
}

Axis make_axis(const Range& range, const std::string& title, const std::string& unit, int min_ticks,
               double margin) {
  const auto [lower, upper] = range;
  if (!std::isfinite(upper - lower) || lower >= upper) {
    throw InputError(
        fmt::format("axis limits [{}, {}], must be finite and ascending", lower, upper));
  }
  const double size = std::max(std::abs(lower), std::abs(upper));
  const int shift = shown_exponent(size);
  Axis axis{lower, upper, title, unit_text(shift, unit), std::pow(10.0, -shift)};

  const double length = (upper - lower) * axis.scale;
  const double first = lower * axis.scale + margin * length;
  const double last = upper * axis.scale - margin * length;
  int decade = static_cast<int>(std::floor(std::log10(length)));
  const int finest = decade - kMostDecades;
  constexpr std::array<double, 5> mantissas = {5.0, 4.0, 3.0, 2.0, 1.0};
  for (std::size_t k = 0; static_cast<int>(axis.ticks.size()) < min_ticks; ++k) {
    if (k == mantissas.size()) {
      k = 0;
      if (--decade < finest) break;  // its ends are neighbors among doubles
    }
    axis.ticks = multiples(first, last, mantissas[k] * std::pow(10.0, decade));
  }
  const int decimals = std::max(0, -decade);
  for (const double tick : axis.ticks) {
    axis.labels.push_back(fmt::format("{:.{}f}", tick + 0.0, decimals));  // + 0.0: no "-0"
  }
  return axis;
}

}  // namespace npdr::analysis
