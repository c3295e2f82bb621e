#include "pipeline/report/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "analysis/report.h"
#include "analysis/table_writers.h"
#include "core/atomic_file.h"
#include "core/shell_text.h"
#include "core/text.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/config/check.h"
#include "pipeline/features/failures.h"
#include "pipeline/findings/findings.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/plan/report_marker.h"
#include "pipeline/process/build_info.h"
#include "pipeline/report/parts.h"

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

// The text above the tables of policies.
std::string policy_prose(const ReportData& data) {
  const PolicyConfig& policy = data.plan.study.policy;
  return fmt::format(
      "{}; searched for by {}: {} candidates an iteration, each on {} samples of what the method "
      "believes and {} initial states.",
      task_info(data).policy, name_of(policy.search.kind), policy.search.population,
      policy.num_domain_parameters, policy.num_initial_states);
}

// The parts of the page in their order, the answers first, without tables and figures.
std::vector<std::pair<Section, analysis::ReportSection>> headings(const ReportData& data) {
  const Study& study = data.plan.study;
  const bool simulates = study.source().simulates;
  return {{Section::posteriors,
           {.title = "Which parameters, and how sure?",
            .remarks = pooling_text(study),
            .figures_first = true}},
          {Section::fit,
           {.title = "How well do they explain the observation?",
            .remarks = simulates ? study.report.caption : ""}},
          {Section::diagnostics, {.title = "Can the posteriors be trusted?"}},
          {Section::next_steps,
           {.title = "What next?", .code = has_posteriors(data) ? next_steps(data) : ""}},
          {Section::policies,
           {.title = "Policies", .prose = has_policies(data) ? policy_prose(data) : ""}},
          {Section::samples, {.title = "Posterior samples"}},
          {Section::details,
           {.title = "Method by method, round by round",
            .remarks = simulates ? "" : study.report.caption,
            .is_folded = true}}};
}

// Adds the tables and figures of a section.
void fill_section(Section section, const ReportData& data, const fs::path& folder,
                  analysis::ReportSection& made) {
  const auto& symbols = data.plan.study.report.symbols;
  const auto methods = section == Section::policies ? data.policy_methods() : data.methods;
  for (const auto& entry : kTables) {
    if (entry.section != section) continue;
    std::optional<analysis::Table> table = entry.make(data);
    if (!table) {  // an earlier report may have had it, with figures that are no longer true
      analysis::remove_table(entry.name, folder / "tables");
      continue;
    }
    table->name = entry.name;
    table->command = data.plan.command();
    for (analysis::Row& row : table->rows) {
      const auto symbol = symbols.find(row.label);
      if (symbol != symbols.end()) row.symbol = symbol->second;
    }
    made.tables.push_back(*std::move(table));
  }
  for (const auto& entry : kFigures) {
    if (entry.section != section) continue;
    const auto figure = entry.make(data);
    if (!figure) continue;
    analysis::ReportFigure& shown = made.figures.emplace_back(
        analysis::ReportFigure{write_figure(figure->figure, folder / "figures").svg,
                               figure->caption + left_out_methods(methods)});
    if (figure->narrow) shown.narrow = write_figure(*figure->narrow, folder / "figures").svg;
  }
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

// Whether to trust a method, in what, and what would change that; then all findings.
analysis::ReportVerdict verdict_of(const CheckSummary& check) {
  analysis::ReportVerdict verdict{.holds = check.failed.empty(), .words = words_of(check)};
  if (const std::string trust = trust_of(check); !trust.empty()) verdict.words += "\n" + trust;
  const bool is_open = !check.failed.empty() || !check.unknown.empty();
  if (is_open) verdict.words += " What would change that? " + check.reasons.front().advice + ".";
  for (const Finding& reason : check.reasons) {
    verdict.reasons.push_back(reason.where + ": " + join(lines_of(reason), "\n"));
  }
  return verdict;
}

std::string posterior_of(const ReportData& data, const std::string& method) {
  const Use& use = data.runs_of(method).front()->use;
  return link_of(data.plan, data.plan.node(Stage::infer, use), use).string();
}

}  // namespace

template <>
void run<Stage::report>(const Plan& plan, const Node& node, const std::vector<Index>&) {
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
    report.verdicts.push_back(verdict_of(check));
  }
  for (auto& [section, made] : headings(data)) {
    fill_section(section, data, folder, made);
    const bool is_empty = made.tables.empty() && made.figures.empty() && made.code.empty();
    if (!is_empty) report.sections.push_back(std::move(made));
  }
  report.commands = {plan.command()};
  report.provenance = provenance(data, node, making);
  const std::vector<fs::path> files = write_tables(report, folder / "tables");
  analysis::write_report(report, report_path(plan));
  mark_report(node, plan.study.places.origin(), files, checks);
}

std::string pooling_text(const Study& study) {
  std::vector<std::string> names;
  for (const MethodConfig& method : study.methods) {
    if (method.algorithm.kind == inference::Algorithm::npe_nle) names.push_back(method.name);
  }
  if (names.empty()) return "";
  return fmt::format(
      "{} combine{} two kinds of neural networks that learn from the same simulations: one says "
      "which parameters explain the observation (neural posterior estimation, NPE), the other to "
      "which observation parameters lead (neural likelihood estimation, NLE). Each counts as much "
      "as it has proved to predict simulations that neither had seen: its power in the table of "
      "experiments. Where the powers add up to more than 1, both together are narrower than each, "
      "which such simulations bore out.",
      join(names, names.size() == 2 ? " and " : ", "), names.size() == 1 ? "s" : "");
}

std::string next_steps(const ReportData& data) {
  std::map<std::string, CheckSummary> checks;
  for (const CheckSummary& summary : check_summaries(data)) checks[summary.method] = summary;
  std::string text = fmt::format("# Posteriors, seed {}\n", data.seeds.front());
  for (const std::string& method : data.methods) {
    const std::string words = checks.contains(method) ? words_of(checks[method]) : method;
    text += fmt::format("{}    # {}\n", posterior_of(data, method), words);
  }
  // That of which the fewest checks fail, then can't tell, of those that were checked at all.
  const std::string best =
      *std::ranges::min_element(data.methods, {}, [&](const std::string& method) {
        const auto found = checks.find(method);
        if (found == checks.end()) return std::tuple(true, std::size_t{0}, std::size_t{0});
        return std::tuple(false, found->second.failed.size(), found->second.unknown.size());
      });
  if (checks.contains(best) && !checks[best].failed.empty()) {
    text += fmt::format(
        "\n# Checks of {} fail: do first what the verdicts say; its draws may be wrong\n", best);
  }
  return text + fmt::format(
                    "\n# Domain parameters for a simulator of yours: 1000 draws of the posterior, "
                    "one a line\n"
                    "npdr sample {} -n 1000 > theta.csv\n"
                    "\n# In Python, a new one for each training episode\n"
                    "import numpy as np\n"
                    "header = open(\"theta.csv\").readline().strip()\n"
                    "names = [name.split(\" [\")[0] for name in header.split(\",\")]\n"
                    "theta = np.loadtxt(\"theta.csv\", delimiter=\",\", skiprows=1, ndmin=2)\n"
                    "rng = np.random.default_rng(1)\n"
                    "for episode in range(100):\n"
                    "    parameters = dict(zip(names, rng.choice(theta)))\n",
                    shell_word(posterior_of(data, best)));
}

}  // namespace npdr::pipeline
