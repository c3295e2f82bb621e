#include "inference/diagnostics/row_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <set>
#include <unsupported/Eigen/SpecialFunctions>

#include "core/error.h"
#include "inference/diagnostics/finite_rows.h"
#include "inference/diagnostics/levels.h"
#include "inference/nearest_rows.h"

namespace npdr::inference {
namespace {

constexpr double kByChance = 1e-4;
constexpr double kUnique = 0.9;  // share of values that hardly repeat

using Rows = std::vector<Index>;

// P(as many or more of `expected`).
double poisson_tail(Index count, double expected) {
  return count == 0 ? 1.0 : Eigen::numext::igamma(static_cast<double>(count), expected);
}

// A column of x, and how finely its values differ.
struct Column {
  float lowest, highest;
  double spread = 0.0;  // of the quartiles of what isn't at an end; 0: it has few values
  double step = 0.0;    // of its lattice; that of floats, where there is none
  double num_inside = 0.0;
  double expected_pairs = 0.0;  // that agree by chance

  bool is_inside(float value) const { return lowest < value && value < highest; }
  bool is_continuous() const { return step < 1e-3 * spread; }

  // P(`copies` pairs and a group of `largest` agree by chance), at most.
  double chance_of(Index copies, Index largest) const {
    const double others = 2.0 * expected_pairs / num_inside;
    const double of_one = num_inside * std::pow(others, static_cast<double>(largest - 1));
    return std::min(poisson_tail(copies, expected_pairs), of_one);
  }
};

std::size_t num_values(const std::vector<float>& sorted) {
  std::size_t count = 1;
  for (std::size_t i = 1; i < sorted.size(); ++i) count += sorted[i] > sorted[i - 1] ? 1 : 0;
  return count;
}

// Six digits, as programs print them.
bool has_few_digits(const std::vector<float>& values) {
  constexpr std::size_t looked_at = 100;
  const std::size_t stride = std::max<std::size_t>(1, values.size() / looked_at);
  for (std::size_t i = 0; i < values.size(); i += stride) {
    if (std::strtof(fmt::format("{:.6g}", values[i]).c_str(), nullptr) != values[i]) return false;
  }
  return true;
}

// The step of a lattice that all sorted values lie on, a small part of their smallest gap; 0: there
// is none that floats can tell.
double lattice_step(const std::vector<float>& sorted) {
  constexpr double near = 0.1;  // of a step, on either side
  constexpr double rounded = 0x1p-23;
  constexpr int most_parts = 6;
  constexpr Index fewest = 8;
  double smallest = 0.0;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    const double gap = double{sorted[i]} - double{sorted[i - 1]};
    if (gap > 0.0 && (smallest <= 0.0 || gap < smallest)) smallest = gap;
  }
  for (int parts = 1; smallest > 0.0 && parts <= most_parts; ++parts) {
    const double step = smallest / parts;
    Index num_told = 0;
    bool fits = true;
    for (std::size_t i = 1; fits && i < sorted.size(); ++i) {
      const double steps = (double{sorted[i]} - double{sorted[i - 1]}) / step;
      const double rounding =
          rounded * std::abs(double{sorted[i]}) * (1.0 / step + steps / smallest);
      if (!(steps > 0.5) || rounding > near) continue;
      ++num_told;
      fits = std::abs(steps - std::round(steps)) <= near + rounding;
    }
    if (fits && num_told >= fewest) return step;
  }
  return 0.0;
}

// Pairs of sorted values that agree by chance: half of those that are one step apart, in the mean
// over ten; at least 2.6 times what normal values say.
double pairs_by_chance(const std::vector<float>& sorted, double step, double spread) {
  constexpr double steps = 10.0;
  double near = 0.0;
  for (auto value = sorted.begin(); value != sorted.end(); ++value) {
    const double highest = double{*value} + (steps + 0.5) * step;
    const auto above = std::upper_bound(value, sorted.end(), *value);
    near += static_cast<double>(std::upper_bound(above, sorted.end(), highest) - above);
  }
  const auto n = static_cast<double>(sorted.size());
  return std::max(near / (2.0 * steps), n * n * step / spread);
}

Column column_of(const RowMatrixF& x, Index c) {
  constexpr double float_step = 0x1p-23, digits_step = 1e-5;
  constexpr std::size_t fewest = 8, repeats = 3;
  Column column{x.col(c).minCoeff(), x.col(c).maxCoeff()};
  std::vector<float> inside;
  for (const float value : x.col(c)) {
    if (column.is_inside(value)) inside.push_back(value);
  }
  if (inside.size() < fewest) return column;
  std::ranges::sort(inside);
  if (repeats * num_values(inside) < inside.size()) return column;  // a discrete one
  const std::size_t n = inside.size();
  column.num_inside = static_cast<double>(n);
  column.spread = double{inside[3 * n / 4]} - double{inside[n / 4]};
  const double size =
      std::max(std::abs(double{inside[n / 4]}), std::abs(double{inside[3 * n / 4]}));
  column.step =
      std::max(lattice_step(inside), size * (has_few_digits(inside) ? digits_step : float_step));
  if (column.spread > 0.0)
    column.expected_pairs = pairs_by_chance(inside, column.step, column.spread);
  return column;
}

std::vector<Column> columns_of(const RowMatrixF& x) {
  std::vector<Column> columns;
  for (Index c = 0; c < x.cols(); ++c) columns.push_back(column_of(x, c));
  return columns;
}

// Groups of rows that are equal, two or more each.
template <class Matrix>
std::vector<Rows> groups_of(const Matrix& rows) {
  Rows order(static_cast<std::size_t>(rows.rows()));
  std::iota(order.begin(), order.end(), Index{0});
  const auto compare = [&](Index i, Index j) {
    return std::lexicographical_compare(rows.row(i).begin(), rows.row(i).end(), rows.row(j).begin(),
                                        rows.row(j).end());
  };
  std::ranges::sort(order, compare);
  std::vector<Rows> groups;
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && rows.row(order[end]) == rows.row(order[begin])) ++end;
    if (end - begin > 1) {
      groups.emplace_back(order.begin() + static_cast<Index>(begin),
                          order.begin() + static_cast<Index>(end));
    }
  }
  return groups;
}

Index num_different(const RowMatrix& theta, Index d, const Rows& rows) {
  std::set<double> values;
  for (const Index i : rows) values.insert(theta(i, d));
  return std::ssize(values);
}

// Of one group those that differ in all parameters that vary.
Index num_different(const RowMatrix& theta, const std::vector<Index>& varying, const Rows& rows) {
  Index fewest = std::ssize(rows);
  for (const Index d : varying) fewest = std::min(fewest, num_different(theta, d, rows));
  return varying.empty() ? 1 : fewest;
}

// Values of a parameter that rows of others share: x may not depend on those.
bool is_design_of(const RowMatrix& theta, Index num_different_rows) {
  Index most = 0;
  for (Index d = 0; d < theta.cols(); ++d) {
    most = std::max(most, std::ssize(levels_of(theta.col(d))));
  }
  return 2 * most < num_different_rows;
}

Index count_different_rows(const RowMatrix& theta) {
  Index copies = 0;
  for (const Rows& group : groups_of(theta)) copies += std::ssize(group) - 1;
  return theta.rows() - copies;
}

// Copies of the same theta, and whether most rows of it have the same x.
void find_exact(const FiniteRows& rows, const std::vector<Column>& columns, RowCopies& found) {
  Index repeated = 0, all_same = 0, telling = 0;
  for (const Rows& group : groups_of(rows.theta)) {
    ++repeated;
    Index copies = 0;
    for (const Rows& same : groups_of(RowMatrixF(rows.x(group, Eigen::all)))) {
      const Index i = group[static_cast<std::size_t>(same.front())];
      copies += std::ssize(same) - 1;
      for (Index c = 0; c < rows.x.cols(); ++c) {
        const Column& column = columns[static_cast<std::size_t>(c)];
        if (!column.is_inside(rows.x(i, c)) || !column.is_continuous()) continue;
        telling += std::ssize(same) - 1;
        break;
      }
    }
    found.num_exact += copies;
    if (copies + 1 == std::ssize(group)) ++all_same;
  }
  const bool by_chance = static_cast<double>(all_same) < kUnique * static_cast<double>(repeated);
  if (by_chance) found.num_exact = telling;
  found.expected = 0.5 * static_cast<double>(rows.x.rows()) * static_cast<double>(rows.x.rows());
  for (Index d = 0; d < rows.theta.cols(); ++d) {
    found.expected /= static_cast<double>(levels_of(rows.theta.col(d)).size());
  }
}

bool nearly_agree(const FiniteRows& rows, const std::vector<Column>& columns, Index i, Index j) {
  constexpr double nearly = 1e-4;
  for (Index c = 0; c < rows.x.cols(); ++c) {
    const double difference = std::abs(double{rows.x(i, c)} - double{rows.x(j, c)});
    if (difference > nearly * columns[static_cast<std::size_t>(c)].spread) return false;
  }
  return true;
}

// Pairs of neighbors in column c whose x nearly agree, and theta isn't the same.
std::set<std::pair<Index, Index>> near_pairs(const FiniteRows& rows,
                                             const std::vector<Column>& columns, Index c) {
  constexpr std::size_t next = 3;
  const Column& column = columns[static_cast<std::size_t>(c)];
  Rows order;
  for (Index i = 0; i < rows.x.rows(); ++i) {
    if (column.is_inside(rows.x(i, c))) order.push_back(i);
  }
  std::ranges::stable_sort(order, {}, [&](Index i) { return rows.x(i, c); });
  std::set<std::pair<Index, Index>> pairs;
  for (std::size_t k = 0; k < order.size(); ++k) {
    for (std::size_t l = k + 1; l < std::min(order.size(), k + 1 + next); ++l) {
      const auto [i, j] = std::minmax(order[k], order[l]);
      if (rows.theta.row(i) == rows.theta.row(j) || !nearly_agree(rows, columns, i, j)) continue;
      pairs.emplace(i, j);
    }
  }
  return pairs;
}

// Parameters that vary, each in its deviations: others are no dimension, in which rows lie apart.
RowMatrix standardized(const RowMatrix& theta) {
  const RowMatrix varying = theta(Eigen::all, varying_columns_of(theta));
  RowMatrix z = varying.rowwise() - varying.colwise().mean().eval();
  for (Index d = 0; d < z.cols(); ++d) {
    const double deviation = std::sqrt(z.col(d).array().square().mean());
    if (deviation > 0.0) z.col(d) /= deviation;
  }
  return z;
}

Index count_near(const FiniteRows& rows, const std::vector<Column>& columns) {
  constexpr Index fewest_rows = 100, most_compared = 500, num_neighbors = 6;  // its copy, too
  constexpr double near = 1e-3, near_of_one = 1e-4, peaked = 4.0;
  if (rows.x.rows() < fewest_rows) return 0;
  const auto inside = std::ranges::max_element(columns, {}, [](const Column& column) {
    return column.is_continuous() ? column.num_inside : 0.0;
  });
  if (inside == columns.end() || !inside->is_continuous()) return 0;
  const auto pairs = near_pairs(rows, columns, inside - columns.begin());
  const RowMatrix z = standardized(rows.theta);
  const double ratio = z.cols() == 1 ? near_of_one : near;
  const Index stride = std::max<Index>(1, std::ssize(pairs) / most_compared);
  Index found = 0, at = 0;
  for (const auto& [i, j] : pairs) {
    if (at++ % stride != 0) continue;
    double farthest = 0.0;
    for (const Index k : nearest_rows(z, i, num_neighbors)) {
      farthest = std::max(farthest, (z.row(k) - z.row(i)).norm());
    }
    if ((z.row(j) - z.row(i)).norm() < ratio * farthest) found += stride;
  }
  const auto n = static_cast<double>(rows.x.rows()), d = static_cast<double>(z.cols());
  const double expected = 0.5 * peaked * n * std::pow(ratio, d);
  return poisson_tail(found / stride, expected / static_cast<double>(stride)) < kByChance ? found
                                                                                          : 0;
}

}  // namespace

FiniteRows::FiniteRows(const RowMatrix& all_theta, const RowMatrixF& all_x) {
  if (all_theta.rows() != all_x.rows()) throw ShapeError("rows: theta and x must be as many");
  for (Index i = 0; i < all_x.rows(); ++i) {
    if (all_x.row(i).allFinite()) numbers.push_back(i);
  }
  theta = all_theta(numbers, Eigen::all);
  x = all_x(numbers, Eigen::all);
}

Index count_same_rows(const RowMatrix& theta, const RowMatrixF& x) {
  constexpr Index fewest = 3;
  const FiniteRows rows(theta, x);
  const std::vector<Rows> groups = groups_of(rows.x);
  if (groups.empty() || is_design_of(rows.theta, count_different_rows(rows.theta))) return 0;
  const std::vector<Index> varying = varying_columns_of(rows.theta);
  const auto num_columns = static_cast<double>(x.cols());
  Index most = 0;
  for (Index c = 0; c < x.cols(); ++c) {
    const Column column = column_of(rows.x, c);
    if (!(column.spread > 0.0)) continue;
    Index count = 0, copies = 0, largest = 1;
    for (const Rows& group : groups) {
      if (!column.is_inside(rows.x(group.front(), c))) continue;
      const Index different = num_different(rows.theta, varying, group);
      if (different < 2) continue;
      count += different;
      copies += different - 1;
      largest = std::max(largest, different);
    }
    const bool is_chance = column.chance_of(copies, largest) * num_columns > kByChance;
    if (copies + 1 >= fewest && !is_chance) most = std::max(most, count);
  }
  return most;
}

RowCopies find_copies(const RowMatrix& theta, const RowMatrixF& x) {
  const FiniteRows rows(theta, x);
  RowCopies found{.num_rows = rows.x.rows()};
  if (found.num_rows < 2) return found;
  const std::vector<Column> columns = columns_of(rows.x);
  find_exact(rows, columns, found);
  found.num_near = count_near(rows, columns);
  return found;
}

}  // namespace npdr::inference
