/// Quantiles of samples.
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <ranges>
#include <utility>
#include <vector>

namespace npdr {

/// Value of a quantile that falls between two of the sample's: between them, in proportion
/// (definition 7 of Hyndman and Fan 1996), or one of them, where a value between would mix unlike
/// ones.
enum class Between { interpolated, lower, upper };

/// The p-quantile of ascending values, p in [0, 1]: at place p (n - 1), counted from 0. NaN when
/// there are none.
template <std::ranges::random_access_range Values>
auto quantile_of_sorted(const Values& sorted, double p, Between between = Between::interpolated) {
  using T = std::ranges::range_value_t<Values>;
  const auto first = std::ranges::begin(sorted);
  const auto n = std::ranges::end(sorted) - first;
  if (n == 0) return std::numeric_limits<T>::quiet_NaN();
  const double place = p * static_cast<double>(n - 1);
  const auto below = static_cast<decltype(n)>(between == Between::upper ? std::ceil(place) : place);
  if (between != Between::interpolated) return T(first[below]);
  const T weight = static_cast<T>(place - static_cast<double>(below));
  return first[below] + weight * (first[std::min(below + 1, n - 1)] - first[below]);
}

/// The p-quantile of values in any order.
template <std::ranges::random_access_range Values>
auto quantile(Values values, double p, Between between = Between::interpolated) {
  std::ranges::sort(values);
  return quantile_of_sorted(values, p, between);
}

/// A value of the sample: the lower one where the quantile falls between two.
template <std::ranges::random_access_range Values>
auto lower_quantile(const Values& sorted, double p) {
  return quantile_of_sorted(sorted, p, Between::lower);
}

/// The median of values in any order; of an even number the larger one of the middle two.
template <std::ranges::random_access_range Values>
auto upper_median(Values values) {
  using T = std::ranges::range_value_t<Values>;
  const auto middle = std::ranges::begin(values) + std::ranges::ssize(values) / 2;
  std::ranges::nth_element(values, middle);
  return middle == std::ranges::end(values) ? std::numeric_limits<T>::quiet_NaN() : T(*middle);
}

/// Those of the values that are finite, ascending.
template <std::ranges::input_range Values>
std::vector<std::ranges::range_value_t<Values>> sorted_finite(const Values& values) {
  std::vector<std::ranges::range_value_t<Values>> sorted;
  std::ranges::copy_if(values, std::back_inserter(sorted), [](auto v) { return std::isfinite(v); });
  std::ranges::sort(sorted);
  return sorted;
}

}  // namespace npdr
