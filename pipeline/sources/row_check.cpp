#include "pipeline/sources/row_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/error.h"

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

/// Distance between rows of values: root of the mean over those that vary of their squared
/// difference in standard deviations.
class RowDistance {
 public:
  RowDistance(const sim::Trajectories& rows, const std::vector<Index>& good)
      : mean_(Eigen::ArrayXd::Zero(rows.row_size())), scale_(mean_) {
    for (const Index i : good) mean_ += values(rows.row(i));
    mean_ /= static_cast<double>(good.size());
    for (const Index i : good) scale_ += (values(rows.row(i)) - mean_).square();
    scale_ = (scale_ / static_cast<double>(good.size())).sqrt();
    varies_ = scale_ > 1e-9 * mean_.abs();
  }

  bool any_varies() const { return varies_.any(); }

  double operator()(std::span<const float> a, std::span<const float> b) const {
    const Eigen::ArrayXd z = varies_.select((values(a) - values(b)) / scale_, 0.0);
    return std::sqrt(z.square().sum() / static_cast<double>(varies_.count()));
  }

 private:
  static Eigen::ArrayXd values(std::span<const float> row) {
    return Eigen::Map<const Eigen::ArrayXf>(row.data(), std::ssize(row)).cast<double>();
  }

  Eigen::ArrayXd mean_, scale_;
  Eigen::Array<bool, Eigen::Dynamic, 1> varies_;
};

bool is_good(const sim::Trajectories& rows, Index i) {
  return rows.status[static_cast<std::size_t>(i)] == sim::RolloutStatus::ok;
}

std::vector<Index> good_rows(const sim::Trajectories& rows) {
  std::vector<Index> good;
  for (Index i = 0; i < rows.num_rows; ++i) {
    if (is_good(rows, i)) good.push_back(i);
  }
  return good;
}

// Rows that no other is equal to: where they come from can be told. All, where they are too few.
std::vector<Index> telling_rows(const sim::Trajectories& rows, const std::vector<Index>& good) {
  std::vector<Index> telling;
  std::ranges::copy_if(good, std::back_inserter(telling), [&](Index i) {
    return std::ranges::none_of(
        good, [&](Index j) { return i != j && std::ranges::equal(rows.row(i), rows.row(j)); });
  });
  return std::ssize(telling) < kMostRepeated ? good : telling;
}

StreamId stream_of(const GivenRows& rows, Index i) {
  StreamId id = rows.first;
  id.row += static_cast<std::uint64_t>(i);
  return id;
}

// Whether row i, simulated alone, is the same again; if not, whether it is one other row of the
// call, or several that are all the same, such as those where nothing happened.
enum class Repetition { same, other_row, one_of_several, different };

struct Repeated {
  Repetition result;
  Index other = 0;
};

Repeated repeat(RowSimulator& simulator, const GivenRows& rows, Index i,
                const std::vector<Index>& good, const RowDistance& distance) {
  const sim::Trajectories again = simulator.simulate(rows.complete.row(i), stream_of(rows, i));
  const bool failed = !is_good(again, 0);  // which is counted elsewhere
  if (failed || distance(again.row(0), rows.result.row(i)) < kSame) return {Repetition::same};
  Index num_found = 0, found = 0;
  for (const Index j : good) {
    if (distance(again.row(0), rows.result.row(j)) >= kIdentical) continue;
    found = j;
    ++num_found;
  }
  if (num_found == 0) return {Repetition::different};
  return num_found == 1 ? Repeated{Repetition::other_row, found}
                        : Repeated{Repetition::one_of_several};
}

// Whether rows are the same again. Random numbers that aren't the row's own are no other order,
// even where one row happens to be like another: that is one only if all that moved are other rows.
bool are_repeatable(RowSimulator& simulator, const GivenRows& rows, const std::vector<Index>& good,
                    const std::vector<Index>& telling, const RowDistance& distance) {
  Index row = 0, other = 0, num_moved = 0, num_unclear = 0;
  bool is_certain = true;
  for (Index k = 1; k <= kMostRepeated && is_certain; ++k) {
    if (k > kRepeated && num_moved + num_unclear == 0) break;
    const Index i =
        telling[static_cast<std::size_t>((k * std::ssize(telling) - 1) / kMostRepeated)];
    const Repeated found = repeat(simulator, rows, i, good, distance);
    is_certain = found.result != Repetition::different;
    num_unclear += found.result == Repetition::one_of_several ? 1 : 0;
    if (found.result != Repetition::other_row) continue;
    row = i;
    other = found.other;
    ++num_moved;
  }
  if (!is_certain) return false;
  if (num_moved + num_unclear == 0) return true;
  if (num_moved < 2) return false;
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
    if (!is_good(x, c)) return Noise::own;
    const bool is_same = distance(x.row(c), x.row(c - c % 2)) < kNoNoise;
    are_pairs_same = are_pairs_same && is_same;
    are_all_same = are_all_same && is_same && distance(x.row(c), rows.result.row(i)) < kNoNoise;
  }
  if (are_all_same) return Noise::none;
  return are_pairs_same ? Noise::shared : Noise::own;
}

}  // namespace

Findings check_rows(RowSimulator& simulator, const GivenRows& rows, bool has_noise) {
  const std::vector<Index> good = good_rows(rows.result);
  if (std::ssize(good) < kFewestRows) return {};
  const RowDistance distance(rows.result, good);
  if (!distance.any_varies()) return {warning(kSameRows)};
  Findings found;
  const std::vector<Index> telling = telling_rows(rows.result, good);
  const Index middle = telling[telling.size() / 2];
  const bool is_repeatable = are_repeatable(simulator, rows, good, telling, distance);
  if (!is_repeatable) {
    found.push_back(warning(
        "a row that is simulated again on its own, with the same parameters and seed, is another: "
        "it depends on the other rows of its call, on calls before it, or on random numbers that "
        "aren't made from the row's seed alone; npdr verify and runs that are repeated get other "
        "rows"));
  }
  const Noise noise = noise_of(simulator, rows, middle, distance);
  if (noise == Noise::shared) {
    found.push_back(warning(
        "all rows of a call share their noise: with the same parameters and different seeds they "
        "are the same; draw each row's from its own seed, or the posterior is too narrow"));
  } else if (noise == Noise::none && !has_noise) {
    found.push_back(warning(
        "rows of the same parameters are the same, whatever their seeds, and the study adds no "
        "observation noise: the posterior assumes that measurements are exact; set "
        "observation_noise.scale, or draw noise from each row's seed"));
  }
  return found;
}

}  // namespace npdr::pipeline
