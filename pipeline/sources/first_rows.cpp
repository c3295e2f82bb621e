#include "pipeline/sources/first_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text.h"
#include "inference/diagnostics/row_faults.h"
#include "inference/feature_transform.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

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

constexpr std::array<Probe<FirstRows>, 4> kProbes = {{
    {"not_repeatable",
     [](const FirstRows& rows) {
       return check_rows(rows.simulator, rows.given, !rows.study.observation_noise.is_silent());
     },
     [](const FirstRows& rows) { return rows.study.source().takes_seeds; }},
    {"lost_precision", find_lost_states},
    {"constant_rows",
     [](const FirstRows& rows) { return find_constant_rows(features_of(rows.given.result)); },
     is_foreign},
    {"program", [](const FirstRows& rows) { return rows.simulator.last_warnings(); }},
}};

Findings find_stretch_in(const RowsTogether& rows) {
  const auto found = inference::find_stretch(rows.theta, rows.x);
  if (!found) return {};
  const auto number = [&](Index i) {
    return rows.numbers.empty() ? i : rows.numbers[static_cast<std::size_t>(i)];
  };
  return {{.severity = Severity::wrong,
           .what = fmt::format("rows {} to {} don't go with their parameters as other rows do",
                               number(found->begin), number(found->begin + found->count - 1)),
           .evidence = fmt::format("mean rank of deviations {:.2f} (right: 0.5)", found->mean_rank),
           .advice = "Mend these rows or leave them out"}};
}

Findings find_same_in(const RowsTogether& rows) {
  constexpr double grave = 0.05;
  const Index count = inference::count_same_rows(rows.theta, rows.x);
  if (count == 0) return {};
  const bool is_grave = static_cast<double>(count) > grave * static_cast<double>(rows.x.rows());
  return {{.severity = is_grave ? Severity::wrong : Severity::suspicious,
           .what = "rows have the very x of others, though their parameters differ",
           .evidence = fmt::format("{} of {} rows (usual: none)", count, rows.x.rows()),
           .advice = "Write NaN if such rows stand for a failure"}};
}

Findings find_codes_in(const RowsTogether& rows) {
  std::vector<std::string> found;
  for (const inference::CodedColumn& code : inference::find_codes(rows.x)) {
    found.push_back(fmt::format("'{}' is {}{:.6g} in {} of {} rows",
                                rows.features[static_cast<std::size_t>(code.column)].label,
                                code.is_exact ? "" : "about ", code.value, code.count,
                                rows.x.rows()));
  }
  if (found.empty()) return {};
  return {
      {.what = join(few_shortened(found)) + ", further from all other values than these lie apart",
       .advice = "Write NaN if such values stand for a failure"}};
}

constexpr std::array<Probe<RowsTogether>, 3> kApart = {{
    {"stretch", find_stretch_in},
    {"same_rows", find_same_in},
    {"codes", find_codes_in, [](const RowsTogether& rows) { return !rows.features.empty(); }},
}};

}  // namespace

Findings find_in_first_rows(const FirstRows& rows) { return find_by(kProbes, rows); }

Findings find_constant_rows(const RowMatrixF& x) {
  constexpr Index fewest = 8;
  Index first = 0, num_finite = 0;
  for (Index i = 0; i < x.rows(); ++i) {
    if (!x.row(i).allFinite()) continue;
    if (num_finite == 0) first = i;
    if (x.row(i) != x.row(first)) return {};
    ++num_finite;
  }
  if (num_finite < fewest) return {};
  return {
      warning(fmt::format("all {} finite rows of the first {} are the same, whatever their "
                          "parameters",
                          num_finite, x.rows()))};
}

Index num_rows_together(Index num_values) {
  constexpr Index most_rows = 20'000, most_values = Index{1} << 25;
  return std::min(most_rows, most_values / std::max<Index>(1, num_values));
}

Findings find_apart(const RowsTogether& rows) { return find_by(kApart, rows); }

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

Findings find_apart_in_first(const FirstRows& rows) {
  const SourceTraits& source = rows.study.source();
  if (source.gives_motion || !source.calls_program) return {};
  return find_apart({rows.given.complete, features_of(rows.given.result), rows.columns});
}

}  // namespace npdr::pipeline
