#include "pipeline/report/report.h"

#include <fmt/format.h>

#include <iterator>
#include <set>

#include "analysis/report.h"
#include "analysis/table_writers.h"
#include "core/atomic_file.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/target_file.h"
#include "pipeline/config/study_json.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/plan/report_marker.h"
#include "pipeline/plan/shards.h"
#include "pipeline/process/build_info.h"
#include "pipeline/report/dataset.h"
#include "pipeline/report/densities.h"
#include "pipeline/report/diagnostics.h"
#include "pipeline/report/features.h"
#include "pipeline/report/figures.h"
#include "pipeline/report/parameters.h"
#include "pipeline/report/paths.h"
#include "pipeline/report/policy.h"
#include "pipeline/report/seeds.h"
#include "pipeline/report/tables.h"

namespace npdr::pipeline {
namespace {

Target read_report_target(const Plan& plan) {
  return read_target_artefact(plan.node(Stage::target, {}));
}

std::optional<Target> read_report_held_out(const Plan& plan) {
  if (plan.study.target.held_out == 0) return std::nullopt;
  return read_recording(plan.node(Stage::held_out, {}).path);
}

std::vector<std::pair<std::string, std::string>> provenance(const Plan& plan, const Node& node) {
  return {{"study", plan.study.name},
          {"report key", node.key},
          {"program", "npdr " + creator_version()},
          {"git revision", git_revision()},
          {"instruction set", instruction_set()},
          {"host", host_name()}};
}

bool shows_rounds(const Study& study) {
  return study.evaluate.rounds == EvaluatedRounds::all && !study.evaluate.metrics.empty();
}

analysis::ReportSection fit_section(const ReportData& data, const Target& target,
                                    const std::optional<Target>& held_out) {
  const bool is_dataset = !data.plan.study.source().simulates;
  analysis::ReportSection section{is_dataset ? "Experiments" : "Fit to the target domain", "", {}};
  section.remarks = data.plan.study.report.caption;
  if (!is_dataset) {
    section.tables.push_back(fit_table(data));
    note_recorded_goal(data, target, held_out, section.tables.front());
  }
  if (data.plan.study.source().predicts_features())
    section.tables.push_back(features_table(data, target));
  if (shows_rounds(data.plan.study)) {
    section.tables.push_back(rounds_table(data));
    section.tables.push_back(densities_table(data));
  }
  section.tables.push_back(seeds_table(data));
  return section;
}

analysis::ReportSection posterior_section(const ReportData& data,
                                          const std::filesystem::path& folder) {
  analysis::ReportSection section{
      "Posteriors", "", {parameters_table(data), contraction_table(data)}, {}};
  note_foreign_theta(data, section.tables.front());
  if (data.plan.study.prior.size() > 1) {
    section.figures.push_back(
        {write_pair_figure(data, folder),
         fmt::format("Posterior samples of seed {}. Limits are the prior's.{}{}",
                     data.seeds.front(), left_out_methods(data),
                     left_out_parameters(data.plan.study))});
  }
  return section;
}

analysis::ReportSection prediction_section(const ReportData& data, const Target& target,
                                           const std::optional<Target>& held_out,
                                           const std::filesystem::path& folder) {
  analysis::ReportSection section{
      "Recorded and predicted trajectories",
      "",
      {},
      {{write_trajectory_figure(data, target, folder),
        fmt::format("Recorded states, predictive median and 90 % band of seed {}.{}",
                    data.seeds.front(), left_out_methods(data))}}};
  if (const auto paths = write_path_figure(data, target, held_out, folder)) {
    section.figures.push_back(
        {*paths,
         fmt::format("Seen from above: the target's paths, and paths and shapes at the first "
                     "{} posterior samples of seed {}. Black: what no parameter moves.{}",
                     kDrawnSamples, data.seeds.front(), left_out_methods(data))});
  }
  return section;
}

// A limit that was lowered after the posteriors were made stops the study all the same.
void check_failed_rows_of_all(const Plan& plan) {
  for (const Node& node : plan.nodes) {
    if (node.stage == Stage::simulate && is_complete(plan, node)) open_simulation(plan, node);
  }
}

// An earlier report may have had others, with figures that are no longer true.
void remove_other_tables(const analysis::Report& report, const std::filesystem::path& folder) {
  std::set<std::string> others = {"fit",   "features",   "rounds",      "densities",
                                  "seeds", "parameters", "contraction", "diagnostics"};
  others.insert(std::begin(kPolicyTables), std::end(kPolicyTables));
  for (const analysis::ReportSection& section : report.sections) {
    for (const analysis::Table& table : section.tables) others.erase(table.name);
  }
  for (const std::string& name : others) analysis::remove_table(name, folder);
}

}  // namespace

void run_report(const Plan& plan, const Node& node) {
  check_failed_rows_of_all(plan);
  const ReportData data = read_report_data(plan, node);
  const std::filesystem::path folder = plan.work.study(plan.study.name);
  const std::filesystem::path figures = folder / "figures";
  make_folder(figures);
  make_folder(folder / "tables");
  unmark_report(node);  // from here on it is neither the old one nor the new one

  analysis::Report report;
  report.title = plan.study.report.title.empty() ? plan.study.name : plan.study.report.title;
  const Target target = read_report_target(plan);
  const std::optional<Target> held_out = read_report_held_out(plan);
  if (!data.methods.empty()) {
    report.sections = {fit_section(data, target, held_out), posterior_section(data, figures)};
    if (plan.study.source().gives_motion) {
      report.sections.push_back(prediction_section(data, target, held_out, figures));
    }
  }
  if (auto section = policy_section(data, figures)) report.sections.push_back(std::move(*section));
  if (auto section = diagnostics_section(data, figures)) {
    report.sections.push_back(std::move(*section));
  }
  report.commands = {plan.command};
  report.provenance = provenance(plan, node);
  std::vector<std::filesystem::path> files;
  for (const analysis::ReportSection& section : report.sections) {
    for (const analysis::ReportFigure& figure : section.figures) files.push_back(figure.svg);
    for (const analysis::Table& table : section.tables) {
      analysis::write_table(table, folder / "tables");
      files.push_back(folder / "tables" / (table.name + ".md"));
    }
  }
  remove_other_tables(report, folder / "tables");
  analysis::write_report(report, report_path(plan));
  mark_report(node, files);
}

}  // namespace npdr::pipeline
