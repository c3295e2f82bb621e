#include "pipeline/report/report.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "analysis/report.h"
#include "analysis/table_writers.h"
#include "core/atomic_file.h"
#include "core/text.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/config/check.h"
#include "pipeline/features/failures.h"
#include "pipeline/findings/findings.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/plan/report_marker.h"
#include "pipeline/process/build_info.h"
#include "pipeline/report/figure_parts.h"
#include "pipeline/report/policy_parts.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/texts.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

// What the artefacts say of themselves.
struct Making {
  std::map<std::string, Index> builds;  // "npdr 0.1.0 (861ffead3939), AVX2": how many each made
  Cost cost;
  std::string newest;  // when the last one was made
};

Making making_of_artefacts(const Plan& plan) {
  Making making;
  for (const Node& node : plan.nodes) {
    if (node.stage == Stage::report || !is_complete(plan, node)) continue;
    const Provenance made = read_artefact_info(node.path).provenance;
    ++making.builds[fmt::format("npdr {} ({}), {}", made.creator_version, made.git_revision,
                                made.instruction_set)];
    making.cost += made.cost;
    making.newest = std::max(making.newest, made.created);
  }
  return making;
}

std::string target_text(const ReportData& data) {
  const TargetConfig& target = data.plan.study.target;
  const std::string source = target.recording     ? *target.recording
                             : target.observation ? "an observation"
                                                  : "simulated at a known truth";
  if (!data.plan.study.source().gives_motion) return source;
  return fmt::format(
      "{}: {} of {} steps of {:.4g} s{}", source, counted(data.target.num_rollouts(), "rollout"),
      data.target.num_steps(), data.target.dt,
      data.held_out ? fmt::format(", {} more held out", data.held_out->num_rollouts()) : "");
}

std::vector<std::pair<std::string, std::string>> provenance(const ReportData& data,
                                                            const Node& node,
                                                            const Making& making) {
  std::vector<std::string> made_by;
  for (const auto& [build, count] : making.builds) {
    made_by.push_back(fmt::format("{} by {}", counted(count, "artefact"), build));
  }
  return {{"study", data.plan.study.name},
          {"target", target_text(data)},
          {"last result", making.newest},
          {"cost", fmt::format("{:.1f} core-minutes", making.cost.core_seconds / 60.0)},
          {"report key", node.key},
          {"program", "npdr " + creator_version()},
          {"git revision", git_revision()},
          {"instruction set", instruction_set()},
          {"host", host_name()},
          {"made", join(made_by, "; ")}};
}

// Other builds, and other machines, round differently.
std::string warning_of_builds(const std::map<std::string, Index>& builds) {
  if (builds.size() <= 1) return "";
  return fmt::format(
      "Warning: its artefacts were made by {} builds or kinds of machine (below, as made), which "
      "needn't give the same bits; a new folder (--work) has those of one.\n\n",
      builds.size());
}

analysis::ReportSection heading(Section section, const ReportData& data) {
  const Study& study = data.plan.study;
  const bool simulates = study.source().simulates;
  switch (section) {
    case Section::posteriors:
      return {.title = "Which parameters, and how sure?",
              .remarks = pooling_text(study),
              .figures_first = true};
    case Section::fit:
      return {.title = "How well do they explain the observation?",
              .remarks = simulates ? study.report.caption : ""};
    case Section::diagnostics:
      return {.title = "Can the posteriors be trusted?"};
    case Section::next_steps:
      return {.title = "What next?", .code = has_posteriors(data) ? next_steps(data) : ""};
    case Section::policies:
      return {.title = "Policies", .prose = has_policies(data) ? policy_prose(data) : ""};
    case Section::samples:
      return {.title = "Posterior samples"};
    case Section::details:
      return {.title = "Method by method, round by round",
              .remarks = simulates ? "" : study.report.caption,
              .is_folded = true};
  }
  return {};
}

void add_symbols(analysis::Table& table, const std::map<std::string, std::string>& symbols) {
  for (analysis::Row& row : table.rows) {
    const auto symbol = symbols.find(row.label);
    if (symbol != symbols.end()) row.symbol = symbol->second;
  }
}

analysis::ReportFigure draw(const ReportedFigure& made, const std::vector<std::string>& methods,
                            const fs::path& folder) {
  analysis::ReportFigure figure{write_figure(made.figure, folder).svg,
                                made.caption + left_out_methods(methods)};
  if (made.narrow) figure.narrow = write_figure(*made.narrow, folder).svg;
  return figure;
}

analysis::ReportSection make_section(Section section, const ReportData& data,
                                     const fs::path& folder) {
  analysis::ReportSection made = heading(section, data);
  const auto methods = section == Section::policies ? data.policy_methods() : data.methods;
  for (const TableEntry& entry : kTables) {
    if (entry.section != section) continue;
    std::optional<analysis::Table> table = entry.make(data);
    if (!table) {  // an earlier report may have had it, with figures that are no longer true
      analysis::remove_table(entry.name, folder / "tables");
      continue;
    }
    table->name = entry.name;
    table->command = data.plan.command();
    add_symbols(*table, data.plan.study.report.symbols);
    made.tables.push_back(*std::move(table));
  }
  for (const FigureEntry& entry : kFigures) {
    if (entry.section != section) continue;
    const auto figure = entry.make(data);
    if (figure) made.figures.push_back(draw(*figure, methods, folder / "figures"));
  }
  return made;
}

// What the check of diagnoses says, for studies without it.
void warn_of_dependent_failures(const Plan& plan, const std::vector<const Node*>& simulations,
                                std::set<std::string>& warnings) {
  if (plan.study.diagnose.has(Check::failures)) return;
  const FailureResult found = test_failures(plan, simulations);
  if (found.test.num_failed == 0 || found.test.p_value >= plan.study.diagnose.alpha) return;
  warnings.insert(fmt::format("Warning: {} (p = {:.2g}). {}.", words_of(found), found.test.p_value,
                              kFailureAdvice));
}

// Warnings of all simulations, each said once. A limit of failed rows that was
// lowered after the posteriors were made stops the study all the same.
std::string check_simulations(const Plan& plan) {
  std::set<std::string> warnings;
  std::vector<const Node*> simulations;
  for (const Node& node : plan.nodes) {
    if (node.stage != Stage::simulate || !is_complete(plan, node)) continue;
    simulations.push_back(&node);
    for (const std::string& warning : warnings_of(open_simulation(plan, node))) {
      warnings.insert("Warning: " + warning + ".");
    }
  }
  warn_of_dependent_failures(plan, simulations, warnings);
  return fmt::format("{}", fmt::join(warnings, "\n\n"));
}

// Writes the tables; returns what the report consists of besides its page.
std::vector<fs::path> write_tables(const analysis::Report& report, const fs::path& folder) {
  std::vector<fs::path> files;
  for (const analysis::ReportSection& section : report.sections) {
    for (const analysis::ReportFigure& figure : section.figures) {
      files.push_back(figure.svg);
      if (figure.narrow) files.push_back(*figure.narrow);
    }
    for (const analysis::Table& table : section.tables) {
      analysis::write_table(table, folder);
      for (const fs::path& file : analysis::table_files(table.name, folder)) files.push_back(file);
    }
  }
  return files;
}

}  // namespace

void run_report(const Plan& plan, const Node& node) {
  const std::string warnings = check_simulations(plan);
  const ReportData data = read_report_data(plan, node);
  const fs::path folder = plan.work.study(plan.study.name);
  make_folder(folder / "figures");
  make_folder(folder / "tables");
  std::filesystem::remove(node.path);  // from here on it is neither the old one nor the new one

  analysis::Report report;
  report.title = plan.study.report.title.empty() ? plan.study.name : plan.study.report.title;
  const Making making = making_of_artefacts(plan);
  report.prose = warning_of_builds(making.builds) + warnings;
  const std::vector<CheckSummary> checks = check_summaries(data);
  for (const CheckSummary& check : checks) {
    report.verdicts.push_back({check.failed.empty(), words_of(check), check.reasons});
  }
  for (const Section section : kSections) {
    analysis::ReportSection made = make_section(section, data, folder);
    const bool is_empty = made.tables.empty() && made.figures.empty() && made.code.empty();
    if (!is_empty) report.sections.push_back(std::move(made));
  }
  report.commands = {plan.command()};
  report.provenance = provenance(data, node, making);
  const std::vector<fs::path> files = write_tables(report, folder / "tables");
  analysis::write_report(report, report_path(plan));
  mark_report(node, plan.study.places.origin(), files, checks);
}

}  // namespace npdr::pipeline
