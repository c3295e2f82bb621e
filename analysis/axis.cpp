#include "analysis/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/gnuplot.h"
#include "core/error.h"

namespace npdr::analysis {
namespace {

constexpr double kEndMargin = 0.08;

// "10⁻³".
std::string power_of_ten(int exponent) {
  constexpr std::array<const char*, 10> digits = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "10⁻" : "10";
  for (const char c : std::to_string(std::abs(exponent))) {
    text += digits[static_cast<std::size_t>(c - '0')];
  }
  return text;
}

// Multiples of `step` in [lower, upper]. The ends may lie on a multiple but for rounding.
std::vector<double> multiples(double lower, double upper, double step) {
  constexpr double slack = 1e-9;
  std::vector<double> values;
  for (double k = std::ceil(lower / step - slack); k <= upper / step + slack; k += 1.0) {
    values.push_back(k * step);
  }
  return values;
}

}  // namespace

Axis make_axis(double lower, double upper, const std::string& unit, int min_ticks) {
  if (!std::isfinite(upper - lower) || lower >= upper) {
    throw InputError(
        fmt::format("axis limits [{}, {}], must be finite and ascending", lower, upper));
  }
  const double size = std::max(std::abs(lower), std::abs(upper));
  const int exponent = static_cast<int>(std::floor(std::log10(size)));
  const int shift = exponent < -1 || exponent > 3 ? exponent : 0;
  Axis axis;
  axis.scale = std::pow(10.0, -shift);
  const bool has_unit = !unit.empty() && unit != "1";
  const std::string factor = shift != 0 ? power_of_ten(shift) : "";
  const std::string parts = factor + (has_unit && shift != 0 ? " " : "") + (has_unit ? unit : "");
  if (!parts.empty()) axis.unit = "[" + parts + "]";

  const double range = (upper - lower) * axis.scale;
  const double first = lower * axis.scale + kEndMargin * range;
  const double last = upper * axis.scale - kEndMargin * range;
  int decade = static_cast<int>(std::floor(std::log10(range)));
  constexpr std::array<double, 5> mantissas = {5.0, 4.0, 3.0, 2.0, 1.0};
  for (std::size_t k = 0; static_cast<int>(axis.ticks.size()) < min_ticks; ++k) {
    if (k == mantissas.size()) {
      k = 0;
      --decade;
    }
    axis.ticks = multiples(first, last, mantissas[k] * std::pow(10.0, decade));
  }
  const int decimals = std::max(0, -decade);
  for (const double tick : axis.ticks)
    axis.labels.push_back(fmt::format("{:.{}f}", tick + 0.0, decimals));
  return axis;
}

std::string tics_command(const Axis& axis, const std::string& name, const std::string& options,
                         bool labelled) {
  std::string command = "set " + name + "tics nomirror " + options + " (";
  for (std::size_t i = 0; i < axis.ticks.size(); ++i) {
    const std::string label = gnuplot_string(labelled ? axis.labels[i] : "");
    command += fmt::format("{}{} {}", i > 0 ? ", " : "", label, axis.ticks[i]);
  }
  return command + ")\n";
}

}  // namespace npdr::analysis
