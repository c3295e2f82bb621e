#include "pipeline/config/prior_check.h"

#include <fmt/format.h>

#include "core/normal.h"
#include "pipeline/config/constraint.h"

namespace npdr::pipeline {
namespace {

using inference::Marginal;

constexpr double kMostMassOutside = 1e-3;

std::string range_of(const sim::Parameter& p) {
  return fmt::format("what is physically possible, [{}, {}] {}", p.lower, p.upper, p.unit);
}

// What a marginal must be and isn't; "": nothing.
std::string broken_rule(const Marginal& m, const sim::Parameter& p) {
  if (m.kind == Marginal::Kind::normal) {
    if (!(m.b > 0.0)) return "[mean, std] with std > 0";
    const double outside = normal_cdf((p.lower - m.a) / m.b) + normal_cdf((m.a - p.upper) / m.b);
    if (outside <= kMostMassOutside) return "";
    return fmt::format(
        "[mean, std] with at most {} of its mass outside of {}, found {:.2g}; take a smaller std, "
        "uniform or log_uniform",
        kMostMassOutside, range_of(p), outside);
  }
  if (!(m.a < m.b)) return "[low, high] with low < high";
  if (m.kind == Marginal::Kind::log_uniform && !(m.a > 0.0)) {
    return "[low, high] with low > 0 for log_uniform";
  }
  return m.a < p.lower || m.b > p.upper ? "inside of " + range_of(p) : "";
}

}  // namespace

void check_bounds(const Marginal& m, const sim::Parameter& parameter, Reading& reading) {
  const std::string rule = broken_rule(m, parameter);
  if (rule.empty()) return;
  const std::string path = "prior." + m.name;
  reading.fail(path, must_be(path, fmt::format("[{}, {}]", m.a, m.b), rule));
}

}  // namespace npdr::pipeline
