/// Pieces that the tables of a report share.
#pragma once

#include <string>
#include <vector>

#include "analysis/summary.h"
#include "analysis/table.h"
#include "pipeline/findings/data.h"

namespace npdr::pipeline {

using analysis::Cell;
using analysis::Row;
using analysis::Table;

/// A table without rows.
Table empty_table(std::string caption, std::string row_header,
                  const std::vector<std::string>& columns);

void add_columns(Table& table, const std::vector<std::string>& titles);
/// What posteriors are compared with: "prior", "nominal", references, "truth" or "floor".
std::vector<std::string> baseline_names(const ReportData& data);
/// Adds a column for each round that any method has; returns how many.
Index add_round_columns(Table& table, const ReportData& data);

/// Title of one of measured_names(): "RMSE, held out".
std::string title_of(const ReportData& data, const std::string& metric);

/// "NPDR (MAF), 1": the label of a row for each method and seed.
std::string experiment_label(const std::string& method, std::uint64_t seed);

/// Mean and standard deviation; a footnote of `table` says how many samples failed.
Cell cell_of(Table& table, const analysis::Summary& summary);
/// Says how many samples of `cell` failed, where any did.
void note_failed(Table& table, Cell& cell, const analysis::Summary& summary);

/// Mean and standard deviation over seeds; a footnote says of how many, where all rollouts of
/// others failed.
Cell cell_of_seeds(Table& table, const analysis::Summary& summary);

/// Why bands without noise hold less of a recording, which has some; empty where that isn't so.
std::string noiseless_bands_text(const Study& study);

/// Says that the method takes the parameter of `cell` as known.
void note_known(Table& table, Cell& cell);

/// Footnotes for a table of densities: methods that take parameters as known, whose densities can't
/// be compared with those of all parameters; references that set parameters beyond the prior's.
void note_known_parameters(Table& table, const ReportData& data);
void note_fixed_parameters(Table& table, const ReportData& data);

/// "[0.9, 1.1]", and of samples (n) their 5 % and 95 % quantiles.
std::string interval_text(double low, double high);
std::string interval_text(const Vector& samples);

/// A method's samples (n) of parameter d, of all seeds.
Vector samples_of(const ReportData& data, const std::string& method, Index d);
/// The same of a periodic parameter moved by periods to where they lie around their mean.
Vector unwrapped_samples_of(const ReportData& data, const std::string& method, Index d);

/// Adds a row with a cell for each item.
template <class Items, class CellOf>
void add_row(Table& table, std::string label, const Items& items, const CellOf& cell_of_item) {
  Row row{std::move(label), {}};
  for (const auto& item : items) row.cells.push_back(cell_of_item(item));
  table.rows.push_back(std::move(row));
}

/// The samples of all runs, one run after the other.
template <class Runs, class Samples>
Vector pooled(const Runs& runs, const Samples& samples_of) {
  Vector all;
  for (const auto& run : runs) {
    const Vector samples = samples_of(run);
    all.conservativeResize(all.size() + samples.size());
    all.tail(samples.size()) = samples;
  }
  return all;
}

/// Mean and spread of the runs' means.
template <class Runs, class Samples>
analysis::Summary summary_of_means(const Runs& runs, const Samples& samples_of) {
  return analysis::summarize(
      each(runs, [&](const auto& run) { return analysis::summarize(samples_of(run)).mean; }));
}

/// A metric's samples of a run, (n).
inline auto metric_samples(const std::string& metric) {
  return [metric](const EvaluatedRun* run) { return run->evaluation.metrics.at(metric); };
}

}  // namespace npdr::pipeline
