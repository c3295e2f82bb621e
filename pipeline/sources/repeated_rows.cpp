#include "pipeline/sources/repeated_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace npdr::pipeline {
namespace {

constexpr Index kFewestAlike = 3;
constexpr double kUsualShare = 0.9;  // of others: counts are often the same

// Of rows that are the same, those with different theta.
Index count_theta(const RowMatrix& theta, const std::vector<Index>& rows) {
  std::vector<Index> different;
  for (const Index row : rows) {
    const auto is_same = [&](Index other) { return theta.row(row) == theta.row(other); };
    if (std::ranges::none_of(different, is_same)) different.push_back(row);
  }
  return std::ssize(different);
}

}  // namespace

std::string repeated_rows(const RowMatrix& theta, const RowMatrixF& x) {
  const auto is_count = [](float value) { return !(std::abs(value - std::round(value)) > 0.0f); };
  if (x.cols() == 1 || std::ranges::all_of(x.reshaped(), is_count)) return "";
  std::vector<std::vector<Index>> groups;  // rows of the same x
  Index num_finite = 0, unique = 0, most = 0, largest = 0;
  for (Index i = 0; i < x.rows(); ++i) {
    if (!x.row(i).allFinite()) continue;
    ++num_finite;
    const auto group = std::ranges::find_if(
        groups, [&](const std::vector<Index>& rows) { return x.row(rows.front()) == x.row(i); });
    group == groups.end() ? groups.push_back({i}) : group->push_back(i);
  }
  for (const std::vector<Index>& rows : groups) {
    unique += rows.size() == 1 ? 1 : 0;
    if (std::ssize(rows) <= largest) continue;
    largest = std::ssize(rows);
    most = count_theta(theta, rows);
  }
  const Index others = num_finite - largest;
  if (most < kFewestAlike || others < kFewestAlike ||
      static_cast<double>(unique) < kUsualShare * static_cast<double>(others)) {
    return "";
  }
  return fmt::format(
      "{} of the first {} rows are the same to the last bit, though their parameters differ, and "
      "hardly any others are: if that stands for a failure, let them fail, or write NaN, or "
      "posteriors are those of a simulator that gives it",
      most, x.rows());
}

}  // namespace npdr::pipeline
