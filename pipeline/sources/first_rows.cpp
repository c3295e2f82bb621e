#include "pipeline/sources/first_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/begins_at_rest.h"
#include "pipeline/sources/precision.h"
#include "pipeline/sources/repeated_outlier.h"

namespace npdr::pipeline {
namespace {

bool begins_late(const sim::Trajectories& x, Index row, const Target& recorded) {
  for (Index h = 0; h < x.num_rollouts; ++h) {
    const RowMatrix& states = recorded.rollouts[static_cast<std::size_t>(h)].states;
    if (x.rollout(row, h).row(0) != states.row(0).cast<float>()) return false;
  }
  return true;
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

Findings find_outliers(const FirstRows& rows) {
  const SourceTraits& source = rows.study.source();
  if (source.gives_motion || !source.calls_program) return {};
  const Eigen::Map<const RowMatrixF> x = features_of(rows.given.result);
  RepeatedOutliers outliers(x.cols());
  outliers.observe(x);
  return outliers.find(rows.columns);
}

Findings find_late_states(const sim::Trajectories& x, const Target& recorded) {
  if (std::ranges::any_of(recorded.rollouts, analysis::begins_at_rest)) return {};
  Index num_good = 0;
  for (Index i = 0; i < x.num_rows; ++i) {
    if (x.status[static_cast<std::size_t>(i)] != sim::RolloutStatus::ok) continue;
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
        fmt::format("all of the first {} rows are the same, whatever their parameters", x.rows()))};
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
  const Index most = 1 + std::ranges::count_if(largest, [&](Index row) {
                       return theta.row(row) != theta.row(largest.front());
                     });
  if (most < fewest_alike || others < fewest_alike ||
      static_cast<double>(unique) < usual_share * static_cast<double>(others)) {
    return {};
  }
  return {warning(fmt::format(
      "{} of the first {} rows are the same to the last bit, though their parameters differ: if "
      "that stands for a failure, let them fail, or write NaN, or posteriors are wrong",
      most, x.rows()))};
}

}  // namespace npdr::pipeline
