#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "core/error.h"
#include "pipeline/sources/first_rows.h"

namespace npdr::pipeline {
namespace {

constexpr Index kFewestRows = 8;
// Distances in standard deviations of the rows' values: two rows are about 1.4 apart. What vector
// instructions round in another way is below, what was drawn anew above.
constexpr double kSame = 1e-3;
// Rows that are the same numbers, but for how they were rounded.
constexpr double kIdentical = 1e-5;
// Rows that are simulated again, and, where one was another, the most.
constexpr Index kRepeated = 2, kMostRepeated = 6;
// Simulations of one theta are all the same below it, whatever the scale of their noise above.
constexpr double kNoNoise = 1e-7;

// Distance between rows of values: root of the mean over those that vary of their squared
// difference, in deviations of what is usual, and beyond in logarithms: a few values far out don't
// hide the others.
class RowDistance {
 public:
  RowDistance(const sim::Trajectories& rows, const std::vector<Index>& good)
      : center_(rows.row_size()), scale_(rows.row_size()) {
    Eigen::ArrayXd of_one(std::ssize(good));
    const auto median = [&] {
      auto* const middle = of_one.data() + of_one.size() / 2;
      std::nth_element(of_one.data(), middle, of_one.data() + of_one.size());
      return *middle;
    };
    for (Index c = 0; c < rows.row_size(); ++c) {
      for (std::size_t k = 0; k < good.size(); ++k) {
        of_one(static_cast<Index>(k)) = double{rows.row(good[k])[static_cast<std::size_t>(c)]};
      }
      const double mean = of_one.mean();
      const double deviation = std::sqrt((of_one - mean).square().mean());
      center_(c) = median();
      of_one = (of_one - center_(c)).abs();
      const double usual = kNormal * median();
      scale_(c) = usual > 0.0 ? usual : deviation;
    }
    varies_ = scale_ > 1e-9 * center_.abs();
  }

  bool any_varies() const { return varies_.any(); }

  double operator()(std::span<const float> a, std::span<const float> b) const {
    const Eigen::ArrayXd z = varies_.select(scaled(a) - scaled(b), 0.0);
    return std::sqrt(z.square().sum() / static_cast<double>(varies_.count()));
  }

  // Whether half of what varies is the same but for rounding, however small it is.
  bool are_equal(std::span<const float> a, std::span<const float> b) const {
    const Eigen::ArrayXd u = values(a), v = values(b);
    const auto same = varies_ && (u - v).abs() <= kIdentical * u.abs().max(v.abs());
    return (*this)(a, b) < kNoNoise && 2 * same.count() >= varies_.count();
  }

 private:
  static constexpr double kNormal = 1.4826;  // deviations of a normal median deviation

  static Eigen::ArrayXd values(std::span<const float> row) {
    return Eigen::Map<const Eigen::ArrayXf>(row.data(), std::ssize(row)).cast<double>();
  }

  Eigen::ArrayXd scaled(std::span<const float> row) const {
    return ((values(row) - center_) / scale_).unaryExpr([](double z) { return std::asinh(z); });
  }

  Eigen::ArrayXd center_, scale_;
  Eigen::Array<bool, Eigen::Dynamic, 1> varies_;
};

template <class Predicate>
std::vector<Index> filtered(const std::vector<Index>& rows, const Predicate& predicate) {
  std::vector<Index> some;
  std::ranges::copy_if(rows, std::back_inserter(some), predicate);
  return some;
}

std::vector<Index> good_rows(const sim::Trajectories& rows) {
  std::vector<Index> all(static_cast<std::size_t>(rows.num_rows));
  std::iota(all.begin(), all.end(), Index{0});
  return filtered(all, [&](Index i) { return rows.is_ok(i); });
}

// Rows that no other is equal to: where they come from can be told. All, where they are too few.
std::vector<Index> telling_rows(const sim::Trajectories& rows, const std::vector<Index>& good) {
  const auto telling = filtered(good, [&](Index i) {
    return std::ranges::none_of(
        good, [&](Index j) { return i != j && std::ranges::equal(rows.row(i), rows.row(j)); });
  });
  return std::ssize(telling) < kMostRepeated ? good : telling;
}

// Whether rows are the same again. Random numbers that aren't the row's own are no other order,
// even where one row happens to be like another: that is one only if all that have changed are
// other rows, or like several that are all the same, such as those where nothing happened.
bool are_repeatable(RowSimulator& simulator, const GivenRows& rows, const std::vector<Index>& good,
                    const std::vector<Index>& telling, const RowDistance& distance) {
  Index row = 0, other = 0, num_moved = 0, num_changed = 0;
  for (Index k = 1; k <= kMostRepeated && (k <= kRepeated || num_changed > 0); ++k) {
    const Index spread = (kMostRepeated + 1 - k) * std::ssize(telling) / kMostRepeated;
    const Index i = telling[static_cast<std::size_t>(spread - 1)];  // the last one first
    const sim::Trajectories again =
        simulator.simulate(rows.complete.row(i), row_after(rows.first, i));
    const bool failed = !again.is_ok(0);  // which is counted elsewhere
    if (failed || distance(again.row(0), rows.result.row(i)) < kSame) continue;
    // The same numbers, but for how they were rounded.
    const auto alike = filtered(
        good, [&](Index j) { return distance(again.row(0), rows.result.row(j)) < kIdentical; });
    if (alike.empty()) return false;
    ++num_changed;
    if (alike.size() > 1) continue;
    row = i;
    other = alike.front();
    ++num_moved;
  }
  if (num_moved < 2) return num_changed == 0;
  const auto number = [&](Index i) { return rows.first.row + static_cast<std::uint64_t>(i); };
  throw InputError(fmt::format(
      "the simulator gives rows in another order than those of theta: row {} on its own gives what "
      "row {} of the call with {} rows was given; each row of its result must belong to the same "
      "row of theta",
      number(row), number(other), rows.complete.rows()));
}

enum class Noise { own, shared, none };

// One theta, twice in each call that works at the same time, with random numbers of its own.
Noise noise_of(RowSimulator& simulator, const GivenRows& rows, Index i,
               const RowDistance& distance) {
  const Index calls = simulator.num_calls();
  StreamId others = rows.first;
  others.row = kNoRow;
  const sim::Trajectories x =
      simulator.simulate(rows.complete.row(i).replicate(2 * calls, 1), others);
  bool are_pairs_same = true, are_all_same = true;
  for (Index c = 0; c < 2 * calls; ++c) {
    if (!x.is_ok(c)) return Noise::own;
    const bool is_same = distance.are_equal(x.row(c), x.row(c - c % 2));
    are_pairs_same = are_pairs_same && is_same;
    are_all_same = are_all_same && is_same && distance.are_equal(x.row(c), rows.result.row(i));
  }
  if (are_all_same) return Noise::none;
  return are_pairs_same ? Noise::shared : Noise::own;
}

Findings find_not_repeatable(RowSimulator& simulator, const GivenRows& rows,
                             const std::vector<Index>& good, const std::vector<Index>& telling,
                             const RowDistance& distance) {
  if (are_repeatable(simulator, rows, good, telling, distance)) return {};
  return {warning(
      "a row that is simulated again, alone, with the same parameters and seed is another: runs "
      "that are repeated get other rows; make its random numbers from the row's seed alone, and "
      "let nothing depend on other rows and earlier calls")};
}

}  // namespace

Findings check_late_rows(RowSimulator& simulator, const GivenRows& rows) {
  const std::vector<Index> good = good_rows(rows.result);
  if (std::ssize(good) < kFewestRows) return {};
  const RowDistance distance(rows.result, good);
  if (!distance.any_varies()) return {};
  return find_not_repeatable(simulator, rows, good, telling_rows(rows.result, good), distance);
}

Findings check_rows(RowSimulator& simulator, const GivenRows& rows, bool has_noise) {
  const std::vector<Index> good = good_rows(rows.result);
  if (std::ssize(good) < kFewestRows) return {};
  const RowDistance distance(rows.result, good);
  if (!distance.any_varies()) return {};
  const std::vector<Index> telling = telling_rows(rows.result, good);
  Findings found = find_not_repeatable(simulator, rows, good, telling, distance);
  const Noise noise = noise_of(simulator, rows, telling[telling.size() / 2], distance);
  if (noise == Noise::shared) {
    found.push_back(warning(
        "all rows of a call share their noise, so the posterior is too narrow; draw each row's "
        "from its own seed"));
  } else if (noise == Noise::none && !has_noise) {
    found.push_back(warning(
        "rows of the same parameters are the same, whatever their seeds, and the study adds no "
        "observation noise: the posterior assumes that measurements are exact; set "
        "observation_noise.scale, or draw noise from each row's seed"));
  }
  return found;
}

}  // namespace npdr::pipeline
