#include "pipeline/sources/repeated_outlier.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>

#include "core/text.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

constexpr std::size_t kFewestRepeats = 2, kFewestOthers = 3;

struct Repeats {
  double value = 0.0;
  std::size_t count = 0;
};

// `values` are sorted, and begin with the number in question.
std::optional<Repeats> repeats_of_first(std::span<const double> values) {
  const double value = values.front();
  const auto count = static_cast<std::size_t>(std::ranges::count(values, value));
  if (count < kFewestRepeats || values.size() < count + kFewestOthers) return std::nullopt;
  const double nearest = values[count], range = std::abs(values.back() - nearest);
  if (range == 0.0 || std::abs(nearest - value) <= range) return std::nullopt;
  return Repeats{value, count};
}

std::vector<double> finite_values(const Vector& column) {
  std::vector<double> values;
  std::ranges::copy_if(column, std::back_inserter(values),
                       [](double v) { return std::isfinite(v); });
  return values;
}

std::optional<Repeats> repeated_outlier(const Vector& column) {
  std::vector<double> values = finite_values(column);
  if (values.empty()) return std::nullopt;
  std::ranges::sort(values);
  if (const auto smallest = repeats_of_first(values)) return smallest;
  std::ranges::reverse(values);
  return repeats_of_first(values);
}

}  // namespace

std::string repeated_outliers(const RowMatrix& x, const std::vector<Channel>& columns) {
  std::vector<std::string> found;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const auto repeats = repeated_outlier(x.col(static_cast<Index>(c)));
    if (!repeats) continue;
    found.push_back(fmt::format("'{}' is {:.6g} in {} of the first {} rows", columns[c].label,
                                repeats->value, repeats->count, x.rows()));
  }
  if (found.empty()) return "";
  return fmt::format(
      "{}, further from all other values than these lie apart: if that stands for a failure, "
      "write NaN, or posteriors are those of a simulator that gives it",
      join(few_shortened(found)));
}

}  // namespace npdr::pipeline
