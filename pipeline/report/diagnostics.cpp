#include "pipeline/report/diagnostics.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "analysis/calibration_plot.h"
#include "core/text.h"
#include "pipeline/report/figures.h"

namespace npdr::pipeline {
namespace {

using analysis::Cell;
using analysis::Row;
using analysis::Table;
using Runs = std::vector<const DiagnosedRun*>;

std::string title_of(const std::string& check) {
  if (check == "sbc") return "SBC ranks, round 1";
  if (check == "coverage") return "Expected coverage, round 1";
  if (check == "tarp") return "TARP coverage, round 1";
  if (check == "local_c2st") return "Local C2ST at x_o, round 1";
  if (check == "predictive") return "Posterior predictive";
  if (check == "ood") return "x_o among simulations";
  return "Training";
}

Runs runs_of(const ReportData& data, const std::string& method) {
  Runs runs;
  for (const DiagnosedRun& run : data.diagnoses) {
    if (run.use.method == method) runs.push_back(&run);
  }
  return runs;
}

// The methods of the figures to which a check means something.
std::vector<std::string> drawn_methods_with(const ReportData& data, const std::string& check) {
  std::vector<std::string> methods;
  for (const std::string& method : drawn_methods(data)) {
    const Study& study = data.plan.study;
    if (study.diagnose_of(study.method(method)).has(check)) methods.push_back(method);
  }
  return methods;
}

// Bonferroni over the method's checks that have a p-value, and the seeds.
double level_of(const ReportData& data, const std::string& method, const Runs& runs) {
  const DiagnoseConfig config = data.plan.study.diagnose_of(data.plan.study.method(method));
  const auto tests = config.checks.size() - (config.has("training") ? 1 : 0);
  return config.alpha / static_cast<double>(std::max<std::size_t>(tests * runs.size(), 1));
}

std::string seeds_text(std::size_t failed, std::size_t all) {
  return all == 1 ? "" : fmt::format(" in {} of {} seeds", failed, all);
}

Cell training_cell(const Runs& runs) {
  std::size_t failed = 0;
  double gap = 0.0;
  for (const DiagnosedRun* run : runs) {
    const inference::TrainingCheck& check = *run->diagnosis.training;
    failed += check.is_converged ? 0 : 1;
    gap += check.generalization_gap / static_cast<double>(runs.size());
  }
  const std::string verdict =
      failed > 0 ? "NOT converged" + seeds_text(failed, runs.size()) : "converged";
  return fmt::format("{}, gap {:.2g} nats", verdict, gap);
}

Cell test_cell(const std::string& check, const Runs& runs, double level) {
  std::size_t failed = 0;
  double smallest = 1.0;
  for (const DiagnosedRun* run : runs) {
    const double p = run->diagnosis.p_values().at(check);
    failed += p < level ? 1 : 0;
    smallest = std::min(smallest, p);
  }
  const char* sign = runs.size() > 1 ? "≥" : "=";
  if (failed == 0) return fmt::format("passes, p {} {:.2g}", sign, smallest);
  const char* verdict = check == "ood" ? "x_o lies OUTSIDE" : "FAILS";
  return fmt::format("{}{}, p {} {:.2g}", verdict, seeds_text(failed, runs.size()), sign, smallest);
}

Cell cell_of(const ReportData& data, const std::string& method, const std::string& check) {
  const Study& study = data.plan.study;
  if (!study.diagnose_of(study.method(method)).has(check)) return {};
  const Runs runs = runs_of(data, method);
  if (check == "training") return training_cell(runs);
  return test_cell(check, runs, level_of(data, method, runs));
}

double times_usual(const inference::Distance& distance) {
  return distance.median > 0.0 ? distance.observed / distance.median : 0.0;
}

// An observation outside of what was simulated makes all else void: said in a sentence.
void note_outside(const std::string& method, const Runs& runs, double level, Table& table) {
  for (const DiagnosedRun* run : runs) {
    const auto& ood = run->diagnosis.ood;
    if (!ood || ood->p_value >= level) continue;
    table.footnote(fmt::format(
        "{}: the observation lies outside of what was simulated (seed {}: {:.3g} times the usual "
        "distance within the simulations' directions, {:.3g} times beyond them, {:.3g} times to "
        "the nearest simulation); the network extrapolates there, whatever the other checks say",
        method, run->use.seed, times_usual(ood->mahalanobis), times_usual(ood->residual),
        times_usual(ood->nearest)));
    return;
  }
}

void note_unpredicted(const std::string& method, const Runs& runs, double level, Table& table) {
  for (const DiagnosedRun* run : runs) {
    const auto& predictive = run->diagnosis.predictive;
    if (!predictive || predictive->check.p_value >= level) continue;
    Index worst = 0;
    predictive->check.summary_p_value.minCoeff(&worst);
    table.footnote(fmt::format(
        "{}: what its samples predict is unlike the observation (seed {}): all features together, "
        "p = {:.2g}; of single summaries most {}, observed {:.3g}, predicted median {:.3g}, p = "
        "{:.2g}",
        method, run->use.seed, predictive->check.overall.p_value,
        predictive->names[static_cast<std::size_t>(worst)], predictive->observed(worst),
        predictive->median(worst), predictive->check.summary_p_value(worst)));
    return;
  }
}

bool any_has(const ReportData& data, const std::string& check) {
  const Study& study = data.plan.study;
  return std::ranges::any_of(data.methods, [&](const std::string& method) {
    return study.diagnose_of(study.method(method)).has(check);
  });
}

std::string calibration_text(const ReportData& data) {
  const DiagnoseConfig& config = data.plan.study.diagnose;
  const Study& study = data.plan.study;
  const bool calibrates = std::ranges::any_of(data.methods, [&](const std::string& method) {
    return study.diagnose_of(study.method(method)).calibrates();
  });
  if (!calibrates) return "";
  return fmt::format(
      " Those of round 1 concern the network that has learnt from the whole prior, over {} fresh "
      "simulations of it; the others the last round.",
      config.num_simulations);
}

// Checks that the study asks for and that mean nothing to a method.
void note_left_out(const ReportData& data, const std::string& method, Table& table) {
  const Study& study = data.plan.study;
  const DiagnoseConfig applied = study.diagnose_of(study.method(method));
  std::vector<std::string> left_out;
  for (const std::string& check : study.diagnose.checks) {
    if (!applied.has(check)) left_out.push_back(check);
  }
  if (left_out.empty()) return;
  table.footnote(fmt::format("{}: without {}: {}", method, join(left_out),
                             study.source().simulates
                                 ? "there is no network that could be asked about other "
                                   "observations"
                                 : "a dataset can't be asked for other simulations"));
}

const Diagnosis& first_diagnosis(const ReportData& data, const std::string& method) {
  return runs_of(data, method).front()->diagnosis;
}

analysis::ReportFigure rank_figure(const ReportData& data, const std::filesystem::path& folder) {
  analysis::RankPlot plot;
  plot.name = "sbc_ranks";
  for (const inference::Marginal& m : data.plan.study.prior) plot.parameters.push_back(m.name);
  for (const std::string& method : drawn_methods_with(data, "sbc")) {
    const SbcResult& sbc = *first_diagnosis(data, method).sbc;
    RowMatrix counts(static_cast<Index>(sbc.test.chi_square.front().counts.size()),
                     sbc.levels.cols());
    for (Index d = 0; d < counts.cols(); ++d) {
      const auto& bins = sbc.test.chi_square[static_cast<std::size_t>(d)].counts;
      for (Index b = 0; b < counts.rows(); ++b) {
        counts(b, d) = static_cast<double>(bins[static_cast<std::size_t>(b)]);
      }
    }
    plot.methods.push_back({method, counts});
  }
  return {analysis::write_rank_plot(plot, folder).svg,
          fmt::format("Ranks of the true parameters among posterior samples, seed {}: shares over "
                      "the even one. Grey: the band that holds 99 % of the bars of a posterior "
                      "without fault. Too narrow a posterior makes a U, too wide a one an arch, a "
                      "shifted one a slope.{}",
                      data.seeds.front(), left_out_methods(data))};
}

analysis::ReportFigure coverage_figure(const ReportData& data,
                                       const std::filesystem::path& folder) {
  analysis::CoveragePlot plot;
  plot.name = "coverage";
  for (const char* check : {"coverage", "tarp"}) {
    if (drawn_methods_with(data, check).empty()) continue;
    const bool is_tarp = check == std::string("tarp");
    analysis::CoveragePanel panel{is_tarp ? "balls (TARP)" : "highest density", {}};
    for (const std::string& method : drawn_methods_with(data, check)) {
      const Diagnosis& diagnosis = first_diagnosis(data, method);
      const CoverageResult& result = is_tarp ? *diagnosis.tarp : *diagnosis.coverage;
      plot.num_truths = std::max(plot.num_truths, result.levels.size());
      panel.curves.push_back({method, result.coverage.level, result.coverage.coverage});
    }
    plot.panels.push_back(std::move(panel));
  }
  return {
      analysis::write_coverage_plot(plot, folder).svg,
      fmt::format("Share of true parameters within the credible regions of each level, seed {}. "
                  "Below the diagonal: too narrow, above: too wide. Grey: 99 % of the curves of "
                  "a posterior without fault, level by level.{}",
                  data.seeds.front(), left_out_methods(data))};
}

}  // namespace

Table diagnostics_table(const ReportData& data) {
  const DiagnoseConfig& config = data.plan.study.diagnose;
  Table table;
  table.name = "diagnostics";
  table.caption = fmt::format(
      "Checks of the posteriors. A method without fault fails any of its checks, in any of its "
      "seeds, with a probability of at most {}: p is compared with that over the number of the "
      "method's checks and seeds. p: the smallest of the seeds.{}",
      config.alpha, calibration_text(data));
  table.row_header = "Check";
  table.command = data.plan.command;
  for (const std::string& method : data.methods) table.columns.push_back({method, false});
  for (const std::string& check : check_names()) {
    if (!any_has(data, check)) continue;
    Row row{title_of(check), {}};
    for (const std::string& method : data.methods) {
      row.cells.push_back(cell_of(data, method, check));
    }
    table.rows.push_back(std::move(row));
  }
  for (const std::string& method : data.methods) {
    note_left_out(data, method, table);
    const Runs runs = runs_of(data, method);
    note_outside(method, runs, level_of(data, method, runs), table);
    note_unpredicted(method, runs, level_of(data, method, runs), table);
  }
  return table;
}

std::optional<analysis::ReportSection> diagnostics_section(const ReportData& data,
                                                           const std::filesystem::path& folder) {
  const DiagnoseConfig& config = data.plan.study.diagnose;
  if (config.checks.empty() || data.methods.empty()) return std::nullopt;
  analysis::ReportSection section{
      "Can the posteriors be trusted?", "", {diagnostics_table(data)}, {}};
  if (!drawn_methods_with(data, "sbc").empty())
    section.figures.push_back(rank_figure(data, folder));
  if (!drawn_methods_with(data, "coverage").empty() || !drawn_methods_with(data, "tarp").empty()) {
    section.figures.push_back(coverage_figure(data, folder));
  }
  return section;
}

}  // namespace npdr::pipeline
