#include "pipeline/report/report.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "analysis/table_writers.h"
#include "core/atomic_file.h"
#include "core/text.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/features/failures.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/plan/report_marker.h"
#include "pipeline/plan/shards.h"
#include "pipeline/process/build_info.h"
#include "pipeline/report/policy_parts.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/verdicts.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

// Builds that made the artefacts, such as "npdr 0.1.0 (861ffead3939), AVX2", and how many each of
// them.
std::map<std::string, Index> builds_of_artefacts(const Plan& plan) {
  std::map<std::string, Index> builds;
  for (const Node& node : plan.nodes) {
    if (node.stage == Stage::report || !is_complete(plan, node)) continue;
    const Provenance made = read_artefact_info(node.path).provenance;
    ++builds[fmt::format("npdr {} ({}), {}", made.creator_version, made.git_revision,
                         made.instruction_set)];
  }
  return builds;
}

std::vector<std::pair<std::string, std::string>> provenance(
    const Plan& plan, const Node& node, const std::map<std::string, Index>& builds) {
  std::vector<std::string> made_by;
  for (const auto& [build, count] : builds) {
    made_by.push_back(fmt::format("{} by {}", counted(count, "artefact"), build));
  }
  return {{"study", plan.study.name},
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
  switch (section) {
    case Section::fit:
      return {study.source().simulates ? "Fit to the target domain" : "Experiments",
              "",
              {},
              {},
              study.report.caption};
    case Section::posteriors:
      return {"Posteriors", ""};
    case Section::predictions:
      return {"Recorded and predicted trajectories", ""};
    case Section::policies:
      return {"Policies", has_policies(data) ? policy_prose(data) : ""};
    case Section::diagnostics:
      return {"Can the posteriors be trusted?", ""};
  }
  return {};
}

analysis::ReportSection make_section(Section section, const ReportData& data,
                                     const fs::path& folder) {
  analysis::ReportSection made = heading(section, data);
  for (const TableEntry& entry : all_tables()) {
    if (entry.section != section || !entry.exists(data)) continue;
    analysis::Table table = entry.make(data);
    table.name = entry.name;
    table.command = data.plan.command;
    made.tables.push_back(std::move(table));
  }
  for (const FigureEntry& entry : all_figures()) {
    if (entry.section == section && entry.exists(data)) {
      made.figures.push_back(entry.make(data, folder / "figures"));
    }
  }
  return made;
}

// What the check of diagnoses says, for studies without it.
void warn_of_dependent_failures(const Plan& plan, std::set<std::string>& warnings) {
  if (plan.study.diagnose.has(Check::failures)) return;
  std::vector<std::pair<FailureResult, std::uint64_t>> found;  // and their seeds
  for (const Node& node : plan.nodes) {
    if (node.stage != Stage::simulate || !is_complete(plan, node)) continue;
    const FailureResult result = test_failures(plan, {&node});
    if (result.test.num_failed > 0) found.emplace_back(result, node.uses.front().seed);
  }
  const double level =
      plan.study.diagnose.alpha / static_cast<double>(std::max<std::size_t>(found.size(), 1));
  for (const auto& [result, seed] : found) {
    if (result.test.p_value >= level) continue;
    warnings.insert(fmt::format("Warning: {} (seed {}, p = {:.2g}). {}.", words_of(result), seed,
                                result.test.p_value, kFailureAdvice));
    return;
  }
}

// Warnings of all simulations, each said once. A limit of failed rows that was
// lowered after the posteriors were made stops the study all the same.
std::string check_simulations(const Plan& plan) {
  std::set<std::string> warnings;
  for (const Node& node : plan.nodes) {
    if (node.stage != Stage::simulate || !is_complete(plan, node)) continue;
    for (const std::string& warning : warnings_of(open_simulation(plan, node))) {
      warnings.insert("Warning: " + warning + ".");
    }
  }
  warn_of_dependent_failures(plan, warnings);
  return fmt::format("{}", fmt::join(warnings, "\n\n"));
}

// An earlier report may have had others, with figures that are no longer true.
void remove_other_tables(const ReportData& data, const fs::path& folder) {
  for (const TableEntry& entry : all_tables()) {
    if (!entry.exists(data)) analysis::remove_table(entry.name, folder);
  }
}

// Writes the tables; returns what the report consists of besides its page.
std::vector<fs::path> write_tables(const analysis::Report& report, const fs::path& folder) {
  std::vector<fs::path> files;
  for (const analysis::ReportSection& section : report.sections) {
    for (const analysis::ReportFigure& figure : section.figures) files.push_back(figure.svg);
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
  unmark_report(node);  // from here on it is neither the old one nor the new one

  analysis::Report report;
  report.title = plan.study.report.title.empty() ? plan.study.name : plan.study.report.title;
  const std::map<std::string, Index> builds = builds_of_artefacts(plan);
  report.prose = warning_of_builds(builds) + warnings;
  for (const Section section : kSections) {
    analysis::ReportSection made = make_section(section, data, folder);
    if (!made.tables.empty() || !made.figures.empty()) report.sections.push_back(std::move(made));
  }
  report.commands = {plan.command};
  report.provenance = provenance(plan, node, builds);
  const std::vector<fs::path> files = write_tables(report, folder / "tables");
  remove_other_tables(data, folder / "tables");
  analysis::write_report(report, report_path(plan));
  mark_report(node, files, check_summaries(data));
}

}  // namespace npdr::pipeline
