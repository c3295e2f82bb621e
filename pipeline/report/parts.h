/// Pieces that the tables and figures of a report share.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/summary.h"
#include "pipeline/report/registry.h"
#include "sim/policy_task.h"

namespace npdr::pipeline {

using analysis::Cell;
using analysis::Table;

/// A row for each item (a run, a parameter, a method), and columns that are functions of items.
template <class Item>
struct TableOf {
  std::string caption;
  std::string row_header;
  std::vector<Item> rows;
  std::function<std::string(const Item&)> label;  ///< of a row
  /// Of a row: analysis::Row::ideal.
  std::function<std::optional<double>(const Item&)> ideal = {};
  /// Titles, and cells in the row of an item.
  std::vector<std::pair<std::string, std::function<Cell(const Item&)>>> columns = {};
  std::vector<std::size_t> compared = {};     ///< columns of methods that compete
  std::vector<std::string> first_notes = {};  ///< footnotes before those of the cells
  std::vector<std::string> last_notes = {};   ///< and after

  /// Adds a column.
  void add(std::string title, std::function<Cell(const Item&)> cell) {
    columns.emplace_back(std::move(title), std::move(cell));
  }

  /// Adds the column of a method, of which the best of each row is marked.
  void add_compared(std::string title, std::function<Cell(const Item&)> cell) {
    compared.push_back(columns.size());
    add(std::move(title), std::move(cell));
  }

  /// Adds a column for each of `titles`, with `cell`(title, item).
  template <class CellOf>
  void add_each(const std::vector<std::string>& titles, const CellOf& cell) {
    for (const std::string& title : titles) {
      add(title, [title, cell](const Item& item) { return Cell(cell(title, item)); });
    }
  }

  /// All cells, row by row, with their footnotes in that order.
  Table make() const {
    Table table{.name = "", .caption = caption, .row_header = row_header, .compared = compared};
    for (const std::string& note : first_notes) table.add_footnote(note);
    for (const auto& [title, cell] : columns) table.columns.push_back(title);
    for (const Item& item : rows) {
      analysis::Row& row = table.rows.emplace_back(analysis::Row{label(item), {}});
      if (ideal) row.ideal = ideal(item);
      for (const auto& [title, cell] : columns) {
        for (const auto& note : row.cells.emplace_back(cell(item)).notes) table.add_footnote(note);
      }
    }
    for (const std::string& note : last_notes) table.add_footnote(note);
    const auto has_best = [&](const analysis::Row& row) {
      return std::ranges::count(table.best_of(row), true) > 0;
    };
    if (std::ranges::any_of(table.rows, has_best)) {
      table.add_footnote("Bold: the best method of a row");
    }
    return table;
  }
};

/// Title of one of measured_names(): "RMSE, held out".
std::string title_of(const ReportData& data, const std::string& metric);
/// Its best value: 1 of a probability, 0 of an error.
double ideal_of(const std::string& metric);

/// Mean and standard deviation; a footnote says how many samples failed.
Cell cell_of(const analysis::Summary& summary);
/// The cell with that footnote, where any failed.
Cell with_failed(Cell cell, const analysis::Summary& summary);

/// Mean and standard deviation over seeds; a footnote says of how many, where all rollouts of
/// others failed.
Cell cell_of_seeds(const analysis::Summary& summary);

/// That bands without noise contain less than their level of a noisy recording; else empty.
std::string noiseless_bands_text(const Study& study);

/// Parameters that are known, and where evaluations hold their density.
struct KnownPoint {
  std::string name;
  std::map<std::string, double> parameters;  ///< that aren't nominal
  std::function<double(const Evaluation&)> log_prob;
};
/// The nominal parameters, the truth and the references, as far as the study has them.
std::vector<KnownPoint> known_points(const ReportData& data);

/// Footnotes for a table of densities: references that set parameters beyond the prior's; methods
/// that take parameters as known, whose densities can't be compared with those of all parameters.
std::vector<std::string> density_notes(const ReportData& data);

/// "[0.9, 1.1]", and of samples (n) their 5 % and 95 % quantiles.
std::string interval_text(double low, double high);
std::string interval_text(const Vector& samples);

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

/// The methods that figures draw: the first, as many as there are colors.
std::vector<std::string> drawn_methods(std::vector<std::string> methods);
/// A sentence that ends captions: " The first 6 of 7 methods."; "": all are drawn.
std::string left_out_methods(const std::vector<std::string>& methods);

/// Positions in the prior of the parameters that figures show: those that the study picks, or the
/// first.
std::vector<Index> shown_parameters(const Study& study);
/// As left_out_methods(): " 2 of 16 parameters."
std::string left_out_parameters(const Study& study);

/// Quantiles of each column of samples (n, D) at analysis::kIntervalLevels, (D, 5); samples that
/// aren't finite are left out. NaN where none is left.
RowMatrix interval_quantiles(const RowMatrix& samples);

/// Returns or successes of a policy's test.
using Outcome = RowMatrix PolicyOutcomes::*;
/// A policy before any search, or after the last.
enum class Searches { before, after };

/// Tests of a method in the order of seeds: before any search, or after the last.
std::vector<const PolicyTest*> tests_of(const ReportData& data, const std::string& method,
                                        Searches searches);

/// Searches of a method and seed, by iteration.
std::vector<const PolicyHistory*> histories_of(const ReportData& data, const std::string& method,
                                               std::uint64_t seed);

sim::PolicyTaskInfo task_info(const ReportData& data);

}  // namespace npdr::pipeline
