#include "inference/diagnostics/tail_probability.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/constants.h"
#include "core/error.h"
#include "inference/pareto_tail.h"

namespace npdr::inference {
namespace {

constexpr Index kFewestForTail = 40;     // reference values
constexpr Index kFewestAbove = 10;       // of them that a tail is fitted to, or that are counted
constexpr double kSmallestShare = 1e-3;  // of 1 / n: the smallest probability
constexpr double kTenPercent = 1.2816;   // deviations beyond which 10 % of a normal variable lie

// Of sorted values: counts, or zeros and ones, have no smooth tail.
Index num_distinct(const Vector& sorted) {
  Index count = sorted.size() > 0 ? 1 : 0;
  for (Index i = 1; i < sorted.size(); ++i) count += sorted(i) != sorted(i - 1) ? 1 : 0;
  return count;
}

// At least `fewest` of the largest `wanted` values: those above its last one where it goes on
// beyond them, or all that are as large.
Index size_of_tail(const Vector& sorted, Index wanted, Index fewest) {
  const double last = sorted(wanted - 1);
  if (sorted(wanted) != last) return wanted;
  const Index above = (sorted.array() > last).count();
  return above >= fewest ? above : (sorted.array() >= last).count();
}

// The number that is expected of a Poisson variable which is `count` or more with a probability of
// 10 %.
double fewest_expected(Index count) {
  const auto k = static_cast<double>(count);
  if (count == 0) return 0.0;
  return k * std::pow(1.0 - 1.0 / (9.0 * k) - kTenPercent / (3.0 * std::sqrt(k)), 3);
}

}  // namespace

double tail_probability(const Vector& reference, double observed) {
  if (reference.size() < 1) throw InputError("tail probability: no reference values");
  const auto numbered = [](double value) { return std::isnan(value) ? kInfinity : value; };
  Vector sorted = reference.unaryExpr(numbered);
  std::sort(sorted.begin(), sorted.end(), std::greater<>());
  const double value = numbered(observed);
  // A tail of a few values says nothing of what is much rarer than all of them.
  const double smallest = kSmallestShare / static_cast<double>(sorted.size());
  if (std::isinf(value) && sorted(0) < value) return smallest;
  const Index n = sorted.size(), above = (sorted.array() >= value).count();
  const double counted = static_cast<double>(1 + above) / static_cast<double>(1 + n);
  if (above >= kFewestAbove || n < kFewestForTail) return counted;
  const Index in_tail = size_of_tail(sorted, std::max(kFewestAbove, n / 10), kFewestAbove);
  if (in_tail == n) return counted;
  const double threshold = 0.5 * (sorted(in_tail - 1) + sorted(in_tail));
  if (value <= sorted(0) && num_distinct(sorted.head(in_tail)) < in_tail / 2) return counted;
  const Vector excess = sorted.head(in_tail).reverse().array() - threshold;
  if (!excess.allFinite() || excess(in_tail - 1) <= excess(0)) return counted;
  ParetoTail tail = fit_pareto_tail(excess);
  tail.k = std::max(tail.k, 0.0);
  const double share = static_cast<double>(in_tail) / static_cast<double>(n);
  const double fitted = share * tail.probability_beyond(std::max(0.0, value - threshold));
  const double least = std::max(smallest, fewest_expected(above) / static_cast<double>(n));
  return std::isfinite(fitted) ? std::clamp(fitted, least, counted) : counted;
}

double smallest_tail_probability(Index n) {
  const auto count = static_cast<double>(n);
  return n < kFewestForTail ? 1.0 / (1.0 + count) : kSmallestShare / count;
}

}  // namespace npdr::inference
