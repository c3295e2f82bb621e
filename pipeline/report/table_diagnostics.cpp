#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "pipeline/config/check.h"
#include "pipeline/findings/findings.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

bool any_has(const ReportData& data, Check check) {
  return std::ranges::any_of(data.methods,
                             [&](const auto& method) { return data.checks_of(method).has(check); });
}

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
void note_left_out(const ReportData& data, const std::string& method, Table& table) {
  const Study& study = data.plan.study;
  std::vector<std::pair<std::string, std::vector<std::string>>> left_out;  // by reason
  for (const Check check : study.diagnose.checks) {
    const std::string why = study.why_unchecked(check, study.method(method));
    if (why.empty() || traits_of(check).is_of_some_methods) continue;
    if (left_out.empty() || left_out.back().first != why) left_out.push_back({why, {}});
    left_out.back().second.push_back(name_of(check));
  }
  for (const auto& [why, checks] : left_out) {
    table.footnote(fmt::format("{}: without {}: {}", method, join(checks), why));
  }
}

// Empty for posteriors whose normaliser isn't known.
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

// The larger, the better: it tells methods, embeddings and estimators of a study apart.
void add_score(const ReportData& data, Table& table) {
  std::vector<Cell> cells;
  for (const std::string& method : data.methods) cells.push_back(score_of(data, method));
  const auto first = std::ranges::find_if(
      cells, [](const Cell& cell) { return cell.value.index() != 0; });  // not empty
  if (first == cells.end()) return;
  first->notes.push_back(table.footnote(
      "no check, but a score: mean density that the posteriors of fresh simulations give to their "
      "parameters [nats], the larger, the better; of each seed"));
  table.rows.push_back({"log p of fresh truths", cells});
}

Table make_diagnostics_table(const ReportData& data) {
  const DiagnoseConfig& config = data.plan.study.diagnose;
  Table table = empty_table(
      fmt::format(
          "Checks of the posteriors. A method without fault fails any of its checks with a "
          "p-value, "
          "in any of its seeds, with a probability of at most {}: p is compared with that over the "
          "number of the method's checks and seeds. p: the smallest of the seeds.{}",
          config.alpha, calibration_text(data)),
      "Check", data.methods);
  for (const CheckTraits& check : enum_table(Check{})) {
    if (!any_has(data, check.value)) continue;
    table.rows.push_back({std::string(check.title), std::vector<Cell>(data.methods.size())});
  }
  for (std::size_t m = 0; m < data.methods.size(); ++m) {
    const std::string& method = data.methods[m];
    note_left_out(data, method, table);
    for (const Finding& finding : findings_of(data, method)) {
      Cell& cell = std::ranges::find(table.rows, finding.where, &Row::label)->cells[m];
      cell = Cell(finding.evidence);
      if (finding.what.empty()) continue;
      cell.notes.push_back(table.footnote(method + ": " + finding.what));
    }
  }
  add_score(data, table);
  return table;
}

bool has_diagnostics_table(const ReportData& data) {
  return has_posteriors(data) && !data.plan.study.diagnose.checks.empty();
}

}  // namespace

/// One row a check, one column a method. A check fails below alpha over the number of checks and
/// seeds of the method.
TableEntry diagnostics_table() {
  return {"diagnostics", Section::diagnostics, has_diagnostics_table, make_diagnostics_table};
}

}  // namespace npdr::pipeline
