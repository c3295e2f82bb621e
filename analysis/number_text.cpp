#include "analysis/number_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace npdr::analysis {
namespace {

constexpr int kMeanDigits = 3;    // significant, as the paper's tables have them
constexpr int kNumberDigits = 4;  // significant
constexpr int kMaxDecimals = 8;
constexpr double kRounding = 2e-15;  // of equal numbers' mean

// The decimal exponent of |value| after rounding to `digits` significant digits; 0 for 0.
int exponent_of(double value, int digits) {
  const std::string text = fmt::format("{:.{}e}", std::abs(value), digits - 1);
  return std::stoi(text.substr(text.find('e') + 1));
}

std::string formula(const std::string& text, NumberStyle style) {
  return style == NumberStyle::latex ? "$" + text + "$" : text;
}

// Digits of a finite mean and its spread.
struct MeanDigits {
  double std;
  int exponent;  // of the larger number
  bool scaled;   // by that power of ten
  double scale;  // what both are multiplied by
  int decimals;  // of the product
};

MeanDigits digits_of(double mean, double std) {
  const bool has_std = std::isfinite(std);
  if (has_std && std < kRounding * std::abs(mean)) std = 0.0;
  const double size = std::max(std::abs(mean), has_std ? std : 0.0);
  const int exponent = exponent_of(size, kMeanDigits);
  const bool is_precise = exponent < 6 && has_std && std > 0.0 && std < 1.0;
  const bool scaled = (exponent >= 3 && !is_precise) || exponent < -3;
  const double scale = scaled ? std::pow(10.0, -exponent) : 1.0;
  int decimals = std::max(0, kMeanDigits - 1 - (scaled ? 0 : exponent));
  if (has_std && std > 0.0) decimals = std::max(decimals, -exponent_of(std * scale, 1));
  return {std, exponent, scaled, scale, std::min(decimals, kMaxDecimals)};
}

bool shows_all_digits(double value) { return value == std::round(value) && std::abs(value) < 1e6; }

}  // namespace

std::string mean_std_text(double mean, double spread, NumberStyle style) {
  if (!std::isfinite(mean)) return "n/a";
  const auto [std, exponent, scaled, scale, decimals] = digits_of(mean, spread);
  const bool has_std = std::isfinite(std);
  const bool latex = style == NumberStyle::latex;
  std::string text = fmt::format("{:.{}f}", mean * scale, decimals);
  if (has_std) {
    text += fmt::format(" {} {:.{}f}", latex ? "\\pm" : "±", std * scale, decimals);
    if (scaled) text = "[" + text + "]";
  }
  if (!scaled) return formula(text, style);
  if (!latex) return fmt::format("{}e{:+d}", text, exponent);
  const char sign = exponent < 0 ? '-' : '+';
  return fmt::format("${}\\mathrm{{e}}{{{}}}{}$", text, sign, std::abs(exponent));
}

std::string number_text(double value, NumberStyle style) {
  if (std::isnan(value)) return "n/a";
  if (std::isinf(value)) {
    const std::string sign = value < 0.0 ? "-" : "";
    return style == NumberStyle::latex ? "$" + sign + "\\infty$" : sign + "inf";
  }
  if (shows_all_digits(value)) {
    return formula(fmt::format("{:.0f}", value + 0.0), style);  // + 0.0: no "-0"
  }
  const int exponent = exponent_of(value, kNumberDigits);
  if (exponent >= -3 && exponent <= 3) {
    return formula(fmt::format("{:.{}g}", value, kNumberDigits), style);
  }
  const std::string mantissa =
      fmt::format("{:.{}g}", value * std::pow(10.0, -exponent), kNumberDigits);
  if (style == NumberStyle::plain) return fmt::format("{}e{}", mantissa, exponent);
  return fmt::format("${} \\times 10^{{{}}}$", mantissa, exponent);
}

double last_digit(double mean, double std) {
  const MeanDigits digits = digits_of(mean, std);
  return std::pow(10.0, -digits.decimals) / digits.scale;
}

double last_digit(double value) {
  if (!std::isfinite(value) || shows_all_digits(value)) return 0.0;
  return std::pow(10.0, exponent_of(value, kNumberDigits) - kNumberDigits + 1);
}

}  // namespace npdr::analysis
