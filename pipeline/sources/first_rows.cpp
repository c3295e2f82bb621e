#include "pipeline/sources/first_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "analysis/begins_at_rest.h"
#include "core/error.h"
#include "core/text.h"
#include "inference/feature_transform.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

bool begins_late(const sim::Trajectories& x, Index row, const Target& recorded) {
  for (Index h = 0; h < x.num_rollouts; ++h) {
    const RowMatrix& states = recorded.rollouts[static_cast<std::size_t>(h)].states;
    if (x.rollout(row, h).row(0) != states.row(0).cast<float>()) return false;
  }
  return true;
}

// Of rows that are the same, those with different theta.
Index count_theta(const RowMatrix& theta, const std::vector<Index>& rows) {
  std::set<std::vector<double>> different;
  for (const Index row : rows) different.emplace(theta.row(row).begin(), theta.row(row).end());
  return std::ssize(different);
}

// Finite rows, in groups of the same x.
std::vector<std::vector<Index>> groups_of(const RowMatrixF& x) {
  std::vector<std::vector<Index>> groups;
  for (Index i = 0; i < x.rows(); ++i) {
    if (!x.row(i).allFinite()) continue;
    const auto group = std::ranges::find_if(
        groups, [&](const std::vector<Index>& rows) { return x.row(rows.front()) == x.row(i); });
    group == groups.end() ? groups.push_back({i}) : group->push_back(i);
  }
  return groups;
}

// What floats lose of the motion that is replayed, and so of its simulations.
Findings find_lost_states(const FirstRows& rows) {
  const Target& target = rows.target;
  RowMatrix states(0, target.num_states());
  for (const Rollout& rollout : target.rollouts) {
    states.conservativeResize(states.rows() + rollout.states.rows(), Eigen::NoChange);
    states.bottomRows(rollout.states.rows()) = rollout.states;
  }
  return find_lost_precision(states, target.state_channels);
}

// From a simulator or a dataset of the user's.
bool is_foreign(const FirstRows& rows) { return !rows.study.source().is_built_in; }

constexpr std::array<Probe<FirstRows>, 5> kProbes = {{
    {"not_repeatable",
     [](const FirstRows& rows) {
       return check_rows(rows.simulator, rows.given, !rows.study.observation_noise.is_silent());
     },
     [](const FirstRows& rows) { return rows.study.source().takes_seeds; }},
    {"lost_precision", find_lost_states},
    {"same_rows",
     [](const FirstRows& rows) {
       return find_same_rows(rows.given.complete, features_of(rows.given.result));
     },
     [](const FirstRows& rows) { return is_foreign(rows) && find_outliers(rows).empty(); }},
    {"late_states",
     [](const FirstRows& rows) { return find_late_states(rows.given.result, rows.target); },
     [](const FirstRows& rows) { return is_foreign(rows) && rows.study.source().gives_motion; }},
    {"program", [](const FirstRows& rows) { return rows.simulator.last_warnings(); }},
}};

}  // namespace

Findings find_in_first_rows(const FirstRows& rows) { return find_by(kProbes, rows); }

Findings find_late_states(const sim::Trajectories& x, const Target& recorded) {
  if (std::ranges::any_of(recorded.rollouts, analysis::begins_at_rest)) return {};
  Index num_good = 0;
  for (Index i = 0; i < x.num_rows; ++i) {
    if (!x.is_ok(i)) continue;
    if (!begins_late(x, i, recorded)) return {};
    ++num_good;
  }
  if (num_good == 0) return {};
  return {warning(
      "every rollout begins with the very state that it was given: wanted are the states after "
      "each action; where the given one is the first of them, all come a step late")};
}

Findings find_same_rows(const RowMatrix& theta, const RowMatrixF& x) {
  constexpr Index fewest_alike = 3, fewest_of_all = 8;
  constexpr double usual_share = 0.9;  // of others: counts are often the same
  const auto groups = groups_of(x);
  if (groups.empty()) return {};
  if (groups.size() == 1 && std::ssize(groups.front()) >= fewest_of_all) {
    return {warning(
        fmt::format("all {} finite rows of the first {} are the same, whatever their parameters",
                    groups.front().size(), x.rows()))};
  }
  const auto is_count = [](float value) { return !(std::abs(value - std::round(value)) > 0.0f); };
  if (x.cols() == 1 || std::ranges::all_of(x.reshaped(), is_count)) return {};
  Index others = 0, unique = 0;
  const auto size = [](const std::vector<Index>& rows) { return rows.size(); };
  const std::vector<Index>& largest = *std::ranges::max_element(groups, {}, size);
  for (const std::vector<Index>& rows : groups) {
    others += &rows == &largest ? 0 : std::ssize(rows);
    unique += rows.size() == 1 ? 1 : 0;
  }
  const Index most = count_theta(theta, largest);
  if (most < fewest_alike || others < fewest_alike ||
      static_cast<double>(unique) < usual_share * static_cast<double>(others)) {
    return {};
  }
  return {warning(fmt::format(
      "{} of the first {} rows are the same to the last bit, though their parameters differ: if "
      "that stands for a failure, let them fail, or write NaN, or posteriors are wrong",
      most, x.rows()))};
}

Findings find_lost_precision(const RowMatrix& x, const std::vector<Channel>& columns) {
  constexpr Index fewest_finite = 8;
  constexpr double smallest = 1e-6, rounding = 1e-12;  // shares of the mean
  std::vector<Index> finite;
  for (Index i = 0; i < x.rows(); ++i) {
    if (x.row(i).allFinite()) finite.push_back(i);
  }
  if (std::ssize(finite) < fewest_finite) return {};
  std::vector<std::string> lost;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const Eigen::ArrayXd values = x.col(static_cast<Index>(c))(finite);
    const double mean = values.mean();
    // Stable: squares of small deviations may be 0.
    const double deviation =
        (values - mean).matrix().stableNorm() / std::sqrt(static_cast<double>(values.size()));
    const bool is_lost =
        deviation <= smallest * std::abs(mean) + inference::FeatureTransform::kLeastDeviation &&
        deviation > rounding * std::abs(mean);
    if (!is_lost) continue;
    lost.push_back(fmt::format("'{}' by {:.2g} about {:.6g}", columns[c].label, deviation, mean));
  }
  if (lost.empty()) return {};
  return {warning(fmt::format(
      "single precision, in which rows are kept, can't tell apart what varies so little ({}): such "
      "columns are taken for constants, and say nothing of the parameters; subtract an offset from "
      "them or take another unit, in the simulator and in the observation",
      join(few_shortened(lost))))};
}

void RepeatedOutliers::observe(const Eigen::Ref<const RowMatrixF>& x) {
  if (x.cols() != std::ssize(columns_)) throw ShapeError("outliers: another number of columns");
  num_rows_ += x.rows();
  for (Index i = 0; i < x.rows(); ++i) {
    for (Index c = 0; c < x.cols(); ++c) {
      const float value = x(i, c);
      if (!std::isfinite(value)) continue;
      auto& [ends, num_finite] = columns_[static_cast<std::size_t>(c)];
      ++num_finite;
      const bool is_inside = ends.size() == 4 && std::next(ends.begin())->first < value &&
                             value < std::next(ends.rbegin())->first;
      if (is_inside) continue;
      ++ends[value];
      if (ends.size() > 4) ends.erase(std::next(ends.begin(), 2));
    }
  }
}

Findings RepeatedOutliers::find(const std::vector<Channel>& columns) const {
  constexpr Index fewest_repeats = 2, fewest_others = 3;
  if (columns.size() != columns_.size()) throw ShapeError("outliers: another number of names");
  std::vector<std::string> found;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const auto& [ends, num_finite] = columns_[c];
    // `end`: at one end of the numbers, `innermost` the number at the other.
    const auto is_outlier = [all = num_finite](auto end, double innermost) {
      const auto [outermost, count] = *end;
      if (count < fewest_repeats || all - count < fewest_others) return false;
      const double nearest = (++end)->first, range = std::abs(innermost - nearest);
      return range > 0.0 && std::abs(nearest - double{outermost}) > range;
    };
    if (ends.empty()) continue;
    const bool is_smallest = is_outlier(ends.begin(), ends.rbegin()->first);
    if (!is_smallest && !is_outlier(ends.rbegin(), ends.begin()->first)) continue;
    const auto [value, count] = is_smallest ? *ends.begin() : *ends.rbegin();
    found.push_back(
        fmt::format("'{}' is {:.6g} in {} of {} rows", columns[c].label, value, count, num_rows_));
  }
  if (found.empty()) return {};
  return {warning(fmt::format(
      "{}, further from all other values than these lie apart: if that stands for a failure, "
      "write NaN, or posteriors are those of a simulator that gives it",
      join(few_shortened(found))))};
}

Findings find_outliers(const FirstRows& rows) {
  const SourceTraits& source = rows.study.source();
  if (source.gives_motion || !source.calls_program) return {};
  const Eigen::Map<const RowMatrixF> x = features_of(rows.given.result);
  RepeatedOutliers outliers(x.cols());
  outliers.observe(x);
  return outliers.find(rows.columns);
}

}  // namespace npdr::pipeline
