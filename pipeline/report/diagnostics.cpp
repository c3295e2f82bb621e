#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "analysis/calibration_plot.h"
#include "core/text.h"
#include "pipeline/config/check.h"
#include "pipeline/findings/findings.h"
#include "pipeline/findings/probe.h"
#include "pipeline/report/parts.h"

namespace npdr::pipeline {
namespace {

std::string calibration_text(const ReportData& data) {
  const bool calibrates = std::ranges::any_of(
      data.methods, [&](const auto& method) { return data.checks_of(method).calibrates(); });
  if (!calibrates) return "";
  return fmt::format(
      " Those of round 1 concern the network that has learnt from the whole prior, over {} fresh "
      "simulations of it; the others the last round.",
      data.plan.study.diagnose.num_simulations);
}

// Checks that the study asks for and that mean nothing to a method.
void note_left_out(const ReportData& data, const std::string& method,
                   std::vector<std::string>& notes) {
  const Study& study = data.plan.study;
  std::vector<std::pair<std::string, std::vector<std::string>>> left_out;  // by reason
  for (const Check check : study.diagnose.checks) {
    const std::string why = traits_of(check).why_unchecked(study, study.method(method));
    if (why.empty() || traits_of(check).is_of_some_methods) continue;
    if (left_out.empty() || left_out.back().first != why) left_out.push_back({why, {}});
    left_out.back().second.push_back(name_of(check));
  }
  for (const auto& [why, checks] : left_out) {
    notes.push_back(fmt::format("{}: without {}: {}", method, join(checks), why));
  }
}

// The larger, the better: it tells methods, embeddings and estimators of a study apart. Empty for
// posteriors whose normalizer isn't known.
Cell score_of(const ReportData& data, const std::string& method) {
  const auto diagnoses = data.diagnoses_of(method);
  if (diagnoses.empty()) return {};
  const Vector& first = diagnoses.front()->result.truth_log_prob;
  if (first.array().isNaN().all()) return {};  // also without any
  const Vector of_seeds = each(diagnoses, [](const ResultOf<Diagnosis>* diagnosis) {
    return diagnosis->result.truth_log_prob.mean();
  });
  // A truth that was held to be impossible; summaries are of finite numbers.
  if (!of_seeds.allFinite()) return "-inf";
  return analysis::summarize(of_seeds);
}

constexpr const char* kScore = "log p of fresh truths";
using CellsOfMethods = std::map<std::string, Cell>;

// "FAILS, p = 0.001 (fine from 0.01 on)". The network of round 1 needn't be the result.
std::string cell_text(const Finding& verdict, bool is_of_result) {
  std::string word = is_of_result ? "passes" : "not of the result";
  if (verdict.severity == Severity::unknown) word = "can't tell";
  if (verdict.severity == Severity::wrong) word = "FAILS";
  return verdict.evidence.empty() ? word : word + ", " + verdict.evidence;
}

// What checks found, and scores, by the titles of their rows; footnotes are those of one method
// after another.
std::map<std::string, CellsOfMethods> check_cells(const ReportData& data,
                                                  std::vector<std::string>& notes) {
  std::map<std::string, CellsOfMethods> cells;
  for (const std::string& method : data.methods) {
    const MethodResults m(data, method);
    note_left_out(data, method, notes);
    for (const Finding& finding : findings_of(data, method)) {
      Cell& cell = cells[finding.where][method];
      const bool is_verdict = cell.value.index() == 0;  // the first of a check
      if (is_verdict) cell.value = cell_text(finding, m.is_of_result(check_of(finding)));
      if (finding.what.empty()) continue;
      notes.push_back(method + ": " + finding.what);
      cell.notes.push_back(notes.back());
    }
  }
  for (const std::string& method : data.methods) {
    Cell score = score_of(data, method);
    if (score.value.index() == 0) continue;  // empty
    if (!cells.contains(kScore)) {
      score.notes.emplace_back(
          "no check, but a score: mean density that the posteriors of fresh simulations give to "
          "their parameters [nats], the larger, the better; of each seed");
    }
    cells[kScore][method] = score;
  }
  return cells;
}

// The first seed's checks of a method.
const Diagnosis& first_diagnosis(const ReportData& data, const std::string& method) {
  return data.diagnoses_of(method).front()->result;
}

// Adds a panel with the curves that methods have.
template <class CurveOf>
void add_panel(const ReportData& data, const char* title, const CurveOf& curve_of,
               analysis::CoveragePlot& plot) {
  analysis::CoveragePanel panel{title, {}};
  for (const std::string& method : drawn_methods(data.methods)) {
    analysis::CoverageCurve curve = curve_of(method);
    curve.method = method;
    if (curve.level.size() > 0) panel.curves.push_back(std::move(curve));
  }
  if (!panel.curves.empty()) plot.panels.push_back(std::move(panel));
}

}  // namespace

/// One row a check, one column a method. A check fails below alpha over the number of checks and
/// seeds of the method.
std::optional<Table> diagnostics_table(const ReportData& data) {
  const DiagnoseConfig& config = data.plan.study.diagnose;
  if (!has_posteriors(data) || config.checks.empty()) return std::nullopt;
  TableOf<std::string> table{
      .caption = fmt::format(
          "Checks of the posteriors. A method without fault fails any of its checks with a "
          "p-value, in any of its seeds, with a probability of at most {}: p is compared with that "
          "over the number of the method's checks and seeds. p: the smallest of the seeds.{}",
          config.alpha, calibration_text(data)),
      .row_header = "Check",
      .rows = {},
      .label = std::identity()};
  auto cells = check_cells(data, table.first_notes);
  for (const CheckTraits& check : enum_table(Check{})) {
    const auto has_check = [&](const auto& name) { return data.checks_of(name).has(check.value); };
    if (std::ranges::any_of(data.methods, has_check)) table.rows.emplace_back(check.title);
  }
  if (cells.contains(kScore)) table.rows.emplace_back(kScore);
  table.add_each(data.methods, [&](const std::string& method, const std::string& title) {
    return cells[title][method];
  });
  return table.make();
}

/// Histograms of simulation-based calibration's ranks, of the first seed.
std::optional<ReportedFigure> rank_figure(const ReportData& data) {
  std::vector<std::string> methods = drawn_methods(data.methods);
  std::erase_if(methods, [&](const auto& m) { return !data.checks_of(m).has(Check::sbc); });
  if (methods.empty()) return std::nullopt;
  analysis::RankPlot plot;
  plot.name = "sbc_ranks";
  for (const inference::Marginal& m : data.plan.study.prior) plot.parameters.push_back(m.name);
  for (const std::string& method : methods) {
    const SbcResult& sbc = *first_diagnosis(data, method).sbc;
    RowMatrix counts(static_cast<Index>(sbc.test.chi_square.front().counts.size()),
                     sbc.levels.cols());
    for (Index d = 0; d < counts.cols(); ++d) {
      counts.col(d) = each(sbc.test.chi_square[static_cast<std::size_t>(d)].counts,
                           [](auto count) { return static_cast<double>(count); });
    }
    plot.methods.push_back({method, counts});
  }
  return {{figure_of(plot),
           fmt::format("Ranks of the true parameters among posterior samples, seed {}: shares over "
                       "the even one. Gray: the band that holds 99 % of the bars of a posterior "
                       "without fault. Too narrow a posterior makes a U, too wide a one an arch, a "
                       "shifted one a slope.",
                       data.seeds.front())}};
}

/// Coverage of credible regions by their level, of the first seed.
std::optional<ReportedFigure> coverage_figure(const ReportData& data) {
  analysis::CoveragePlot plot{"coverage", {}};
  const auto add = [&](Check check, const char* title, auto result_of) {
    add_panel(
        data, title,
        [&](const std::string& method) -> analysis::CoverageCurve {
          if (!data.checks_of(method).has(check)) return {};
          const CoverageResult& result = *(first_diagnosis(data, method).*result_of);
          plot.num_truths = std::max(plot.num_truths, result.levels.size());
          return {"", result.coverage.level, result.coverage.coverage};
        },
        plot);
  };
  add(Check::coverage, "highest density", &Diagnosis::coverage);
  add(Check::tarp, "balls (TARP)", &Diagnosis::tarp);
  if (plot.panels.empty()) return std::nullopt;
  return {{figure_of(plot),
           fmt::format(
               "Share of true parameters within the credible regions of each level, seed {}. "
               "Of levels above 1/2: below the diagonal posteriors are too narrow, or beside the "
               "truth, above it too wide; of levels below 1/2 so are regions of highest density, "
               "and balls the other way round. Gray: 99 % of the curves of a posterior without "
               "fault, level by level.",
               data.seeds.front())}};
}

/// Coverage of predictive bands by their level, of the first seed.
std::optional<ReportedFigure> band_figure(const ReportData& data) {
  if (!has_rollout_scores(data)) return std::nullopt;
  analysis::CoveragePlot plot{"bands", {}};
  const Eigen::Map<const Vector> levels(kBandLevels.data(), std::ssize(kBandLevels));
  const auto add = [&](const char* title, auto scores_of, auto coverage_of) {
    add_panel(
        data, title,
        [&](const std::string& method) -> analysis::CoverageCurve {
          const auto& scores = data.runs_of(method).front()->evaluation.scores.*scores_of;
          if (!scores || ((*scores).*coverage_of).size() == 0) return {};
          return {"", levels, ((*scores).*coverage_of).rowwise().mean()};  // over channels
        },
        plot);
  };
  using S = PredictionScores;
  add("target rollouts", &RolloutScores::seen, &S::coverage);
  add("target rollouts, with noise", &RolloutScores::seen, &S::noisy_coverage);
  add("held out", &RolloutScores::held_out, &S::coverage);
  add("held out, with noise", &RolloutScores::held_out, &S::noisy_coverage);
  return {{figure_of(plot),
           fmt::format("Share of the recorded states within the samples' central bands of each "
                       "level, mean over channels, seed {}. Below the diagonal: too sure of "
                       "itself, above: too vague.{}",
                       data.seeds.front(), noiseless_bands_text(data.plan.study))}};
}

}  // namespace npdr::pipeline
