#include <fmt/format.h>

#include <cmath>

#include "core/gamma_and_beta.h"
#include "core/normal.h"
#include "pipeline/config/checker.h"

namespace npdr::pipeline {
namespace {

using inference::Marginal;

constexpr double kMostMassOutside = 1e-3;
// Narrower, and doubles hardly tell its values apart.
constexpr double kLeastShare = 1e-12;  // of the values' size
constexpr double kLeastWidth = 1e-300;

bool is_wide_enough(double width, double size) {
  return std::isfinite(width) && width >= std::max(kLeastWidth, kLeastShare * size);
}

std::string width_words() {
  return fmt::format(">= {} and {} of the values' size, and finite", kLeastWidth, kLeastShare);
}

std::string range_of(const sim::Parameter& p) {
  return fmt::format("what is physically possible, [{}, {}] {}", p.lower, p.upper, p.unit);
}

// Probability of what is physically impossible.
double mass_outside(const Marginal& m, const sim::Parameter& p) {
  RowMatrix limits(2, 1);
  limits << p.lower, p.upper;
  const RowMatrix u = inference::Prior({m}).to_normal(limits);
  return normal_cdf(u(0, 0)) + normal_cdf(-u(1, 0));
}

std::string form_of(const Marginal& m) {
  using enum Marginal::Kind;
  if (m.kind == gamma) return "[shape, scale]";
  if (m.kind == beta) return "[a, b]";
  return m.is_log() ? "[mean of log, std of log]" : "[mean, std]";
}

// The same of the numbers of a marginal that isn't uniform.
std::string broken_form(const Marginal& m) {
  const auto is_shape = [](double v) { return v >= kLeastShape && v <= kMostShape; };
  const auto shapes = fmt::format(" of {} to {}", kLeastShape, kMostShape);
  if (m.kind == Marginal::Kind::beta) return is_shape(m.a) && is_shape(m.b) ? "" : shapes;
  if (m.kind == Marginal::Kind::gamma) {
    if (!is_shape(m.a)) return " with a shape" + shapes;
    return m.b >= 1e-100 && m.b <= 1e100 ? "" : " with a scale of 1e-100 to 1e100";
  }
  if (!(m.b > 0.0)) return " with std > 0";
  if (!is_wide_enough(m.b, std::abs(m.a))) return " with std " + width_words();
  if (!m.overflows()) return "";
  return fmt::format(" with {} within the range of double",
                     m.is_log() ? "exp(mean +- 9 std)" : "mean +- 9 std");
}

// The rule that a marginal breaks: what it must be; "" for none.
std::string broken_rule(const Marginal& m, const sim::Parameter& p) {
  if (!m.is_uniform()) {
    const std::string form = form_of(m), broken = broken_form(m);
    if (!broken.empty()) return form + broken;
    if (m.is_cut() && !(m.mass() >= Marginal::kLeastMass)) {
      return fmt::format("{} with {} of its mass or more between lower = {} and upper = {}", form,
                         Marginal::kLeastMass, m.from, m.to);
    }
    const double outside = mass_outside(m, p);
    if (outside <= kMostMassOutside) return "";
    return fmt::format(
        "{} with at most {} of its mass outside of {}, found {:.2g}; cut it off there by lower = "
        "or "
        "upper =",
        form, kMostMassOutside, range_of(p), outside);
  }
  if (m.is_cut()) return "without lower and upper: it has bounds";
  if (!(m.a < m.b)) return "[low, high] with low < high";
  if (!is_wide_enough(m.b - m.a, std::max(std::abs(m.a), std::abs(m.b)))) {
    return "[low, high] with high - low " + width_words();
  }
  if (m.kind == Marginal::Kind::log_uniform && !(m.a > 0.0)) {
    return "[low, high] with low > 0 for log_uniform";
  }
  if (m.overflows()) return "[low, high] with a width within the range of double";
  return m.a < p.lower || m.b > p.upper ? "inside of " + range_of(p) : "";
}

}  // namespace

void check_bounds(const Marginal& m, const sim::Parameter& parameter, Reading& reading) {
  const std::string rule = broken_rule(m, parameter);
  const std::string path = "prior." + m.name;
  if (rule.empty() && !m.is_uniform() && m.physical != inference::PhysicalEnds::none) {
    reading.fail(path, path + ".physical must be left out: " + std::string(name_of(m.kind)) +
                           " has no bounds that posteriors press against");
  }
  if (rule.empty()) return;
  reading.reject(path, fmt::format("[{}, {}]", m.a, m.b), rule);
}

}  // namespace npdr::pipeline
