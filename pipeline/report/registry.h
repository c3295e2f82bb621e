/// All tables and figures of a report. Adding one takes a file with its entry, and its line in the
/// list below.
#pragma once

#include <filesystem>
#include <vector>

#include "analysis/report.h"
#include "pipeline/findings/data.h"

namespace npdr::pipeline {

/// Parts of the page, the answers first; one is shown when anything in it exists.
enum class Section { posteriors, fit, diagnostics, next_steps, policies, samples, details };
inline constexpr Section kSections[] = {
    Section::posteriors, Section::fit,     Section::diagnostics, Section::next_steps,
    Section::policies,   Section::samples, Section::details};

struct TableEntry {
  const char* name;  ///< of its files
  Section section;
  bool (*exists)(const ReportData& data);           ///< whether the study has it
  analysis::Table (*make)(const ReportData& data);  ///< without name and command
};

struct FigureEntry {
  Section section;
  bool (*exists)(const ReportData& data);
  /// Writes the figure into `folder`. Throws Error.
  analysis::ReportFigure (*make)(const ReportData& data, const std::filesystem::path& folder);
};

TableEntry fit_table();
TableEntry features_table();
TableEntry rounds_table();
TableEntry proposals_table();
TableEntry densities_table();
TableEntry seeds_table();
TableEntry scores_table();
TableEntry parameters_table();
TableEntry intervals_table();
TableEntry noise_table();
TableEntry contraction_table();
TableEntry refinement_table();
TableEntry policy_table();
TableEntry policy_seeds_table();
TableEntry policy_parameters_table();
TableEntry policy_cost_table();
TableEntry diagnostics_table();

/// In the order of the report.
inline std::vector<TableEntry> all_tables() {
  return {fit_table(),         scores_table(),       features_table(),
          rounds_table(),      proposals_table(),    densities_table(),
          seeds_table(),       parameters_table(),   intervals_table(),
          noise_table(),       contraction_table(),  refinement_table(),
          policy_table(),      policy_seeds_table(), policy_parameters_table(),
          policy_cost_table(), diagnostics_table()};
}

FigureEntry interval_figure();
FigureEntry pair_figure();
FigureEntry trajectory_figure();
FigureEntry held_out_figure();
FigureEntry path_figure();
FigureEntry feature_figure();
FigureEntry band_figure();
FigureEntry learning_figure();
FigureEntry grid_return_figure();
FigureEntry grid_success_figure();
FigureEntry rank_figure();
FigureEntry coverage_figure();
FigureEntry power_figure();

/// In the order of the report.
inline std::vector<FigureEntry> all_figures() {
  return {interval_figure(),    pair_figure(),         trajectory_figure(), held_out_figure(),
          path_figure(),        feature_figure(),      band_figure(),       learning_figure(),
          grid_return_figure(), grid_success_figure(), rank_figure(),       coverage_figure(),
          power_figure()};
}

}  // namespace npdr::pipeline
