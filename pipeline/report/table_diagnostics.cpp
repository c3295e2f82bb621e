#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/text.h"
#include "pipeline/config/check.h"
#include "pipeline/findings/findings.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

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

// What checks found, and scores, by the titles of their rows; footnotes are those of one method
// after another.
std::map<std::string, CellsOfMethods> check_cells(const ReportData& data,
                                                  std::vector<std::string>& notes) {
  std::map<std::string, CellsOfMethods> cells;
  for (const std::string& method : data.methods) {
    note_left_out(data, method, notes);
    for (const Finding& finding : findings_of(data, method)) {
      Cell& cell = cells[finding.where][method] = finding.evidence;
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

}  // namespace npdr::pipeline
