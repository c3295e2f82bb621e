/// All tables and figures of a report. Adding one takes its maker, beside those it is like, and its
/// line in the list below.
#pragma once

#include <optional>
#include <string>

#include "analysis/figure.h"
#include "analysis/table.h"
#include "pipeline/findings/data.h"

namespace npdr::pipeline {

/// Parts of the page, the answers first; one is shown when anything in it exists.
enum class Section { posteriors, fit, diagnostics, next_steps, policies, samples, details };

struct ReportedFigure {
  analysis::Figure figure;
  std::string caption;
  std::optional<analysis::Figure> narrow = {};  ///< in its place where the page is narrow
};

/// A table without name and command; none where the study has nothing for it.
using TableMaker = std::optional<analysis::Table>(const ReportData& data);
/// The same of a figure.
using FigureMaker = std::optional<ReportedFigure>(const ReportData& data);

template <class Maker>
struct ReportEntry {
  Section section;
  Maker* make;
  const char* name = "";  ///< of a table's files
};

TableMaker fit_table, scores_table, scores_details_table, features_table, rounds_table,
    proposals_table, densities_table, seeds_table, parameters_table, intervals_table, noise_table,
    contraction_table, refinement_table, policy_table, policy_seeds_table, policy_parameters_table,
    policy_cost_table, diagnostics_table;

/// In the order of the report.
inline constexpr ReportEntry<TableMaker> kTables[] = {
    {Section::fit, fit_table, "fit"},
    {Section::fit, scores_table, "scores"},
    {Section::fit, features_table, "features"},
    {Section::details, scores_details_table, "scores_details"},
    {Section::details, rounds_table, "rounds"},
    {Section::details, proposals_table, "proposals"},
    {Section::details, densities_table, "densities"},
    {Section::details, seeds_table, "seeds"},
    {Section::posteriors, parameters_table, "parameters"},
    {Section::posteriors, intervals_table, "intervals"},
    {Section::posteriors, noise_table, "noise"},
    {Section::details, contraction_table, "contraction"},
    {Section::diagnostics, refinement_table, "refinement"},
    {Section::policies, policy_table, "policy"},
    {Section::policies, policy_seeds_table, "policy_seeds"},
    {Section::policies, policy_parameters_table, "policy_parameters"},
    {Section::policies, policy_cost_table, "policy_cost"},
    {Section::diagnostics, diagnostics_table, "diagnostics"}};

FigureMaker interval_figure, pair_figure, trajectory_figure, held_out_figure, path_figure,
    feature_figure, band_figure, learning_figure, grid_return_figure, grid_success_figure,
    rank_figure, coverage_figure, power_figure;

/// In the order of the report.
inline constexpr ReportEntry<FigureMaker> kFigures[] = {{Section::posteriors, interval_figure},
                                                        {Section::samples, pair_figure},
                                                        {Section::fit, trajectory_figure},
                                                        {Section::fit, held_out_figure},
                                                        {Section::fit, path_figure},
                                                        {Section::fit, feature_figure},
                                                        {Section::fit, band_figure},
                                                        {Section::policies, learning_figure},
                                                        {Section::policies, grid_return_figure},
                                                        {Section::policies, grid_success_figure},
                                                        {Section::diagnostics, rank_figure},
                                                        {Section::diagnostics, coverage_figure},
                                                        {Section::diagnostics, power_figure}};

}  // namespace npdr::pipeline
