#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/constants.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

using Scores = std::vector<const PredictionScores*>;

// Rollouts that are scored: what the rows are called, and the scores of a run and of a baseline,
// which may have none.
struct Part {
  std::string where;
  std::function<Scores(const EvaluatedRun&)> of_run;
  std::optional<PredictionScores> RolloutScores::*of_baseline;
};

bool has_scores_table(const ReportData& data) {
  return std::ranges::any_of(
      data.runs, [](const EvaluatedRun& run) { return run.evaluation.scores.seen.has_value(); });
}

bool has_noise(const ReportData& data) { return !data.plan.study.observation_noise.is_silent(); }

Index row_of_level(double level) {
  return std::ranges::find(kBandLevels, level) - kBandLevels.begin();
}

template <class Number>
Cell baseline_cell(const RolloutScores& scores, const Part& part, const Number& number) {
  if (part.of_baseline == nullptr) return {};
  return number(*(scores.*part.of_baseline));
}

// A row with one number a method and seed, and a baseline.
template <class Number>
void add(Table& table, const ReportData& data, const std::string& label, const Part& part,
         const Number& number) {
  add_row(table, label + part.where, data.methods, [&](const std::string& method) {
    const Vector of_seeds = each(data.runs_of(method), [&](const EvaluatedRun* run) {
      return each(part.of_run(*run), [&](const PredictionScores* s) { return number(*s); }).mean();
    });
    // A log score of what was held to be impossible; summaries are of finite numbers.
    if (of_seeds.size() > 0 && of_seeds.minCoeff() == -kInfinity) return Cell("-inf");
    return cell_of_seeds(table, analysis::summarize(of_seeds));
  });
  std::vector<Cell>& cells = table.rows.back().cells;
  if (const auto& prior = data.baseline.prior) {
    cells.push_back(baseline_cell(prior->scores, part, number));
  }
  for (const BaselinePoint& point : data.baseline.points) {
    cells.push_back(baseline_cell(point.scores, part, number));
  }
}

bool has_log_score(const ReportData& data, const Part& part) {
  return std::ranges::all_of(data.runs, [&](const EvaluatedRun& run) {
    return part.of_run(run).front()->log_score.size() > 0;
  });
}

// All rows of the rollouts that were seen, left out or held out.
void add_part(Table& table, const ReportData& data, const Part& part) {
  using S = PredictionScores;
  add(table, data, "CRPS", part, [](const S& s) { return s.crps.mean(); });
  if (has_noise(data)) {
    add(table, data, "CRPS with noise", part, [](const S& s) { return s.noisy_crps.mean(); });
  }
  if (has_log_score(data, part)) {
    add(table, data, "log score", part, [](const S& s) { return s.log_score.mean(); });
  }
  for (const double level : {0.5, 0.9}) {
    const Index row = row_of_level(level);
    const std::string bands = fmt::format("{:.0f} % bands cover", 100.0 * level);
    add(table, data, bands, part, [row](const S& s) { return s.coverage.row(row).mean(); });
    if (!has_noise(data)) continue;
    add(table, data, bands + ", with noise", part,
        [row](const S& s) { return s.noisy_coverage.row(row).mean(); });
  }
  Index c = 0;
  for (const Channel& channel : data.info.state_channels) {
    add(table, data, "CRPS of " + channel.label, part, [c](const S& s) { return s.crps(c); });
    ++c;
  }
}

std::vector<Part> parts_of(const ReportData& data) {
  std::vector<Part> parts = {
      {"", [](const EvaluatedRun& run) { return Scores{&*run.evaluation.scores.seen}; },
       &RolloutScores::seen}};
  if (!data.folds.empty()) {
    const auto of_folds = [&data](const EvaluatedRun& run) {
      Scores scores;
      for (const EvaluatedRun* fold : data.folds_of(run.use)) {
        scores.push_back(&*fold->evaluation.scores.held_out);
      }
      return scores;
    };
    parts.push_back({", left out", of_folds, nullptr});
  }
  if (data.held_out) {
    parts.push_back(
        {", held out",
         [](const EvaluatedRun& run) { return Scores{&*run.evaluation.scores.held_out}; },
         &RolloutScores::held_out});
  }
  return parts;
}

std::string caption(const ReportData& data) {
  std::string text =
      "How well posterior samples predict the stored states together, and how sure one can be of "
      "it: mean over channels, mean and standard deviation over seeds. CRPS: continuous ranked "
      "probability score over the channel's largest recorded magnitude, smaller is better; log "
      "score: of the density with noise of a state, over the same [nats], larger is better; bands: "
      "share of the recorded states that they hold, best as much as they are called.";
  text += noiseless_bands_text(data.plan.study);
  if (data.folds.empty()) return text;
  return text + fmt::format(
                    " Left out: {} times the method was repeated without a part of the rollouts, "
                    "to predict that part; mean over the parts.",
                    data.plan.study.evaluate.leave_out);
}

Table make_scores_table(const ReportData& data) {
  Table table = empty_table(caption(data), "Score", data.methods);
  add_columns(table, baseline_names(data));
  for (const Part& part : parts_of(data)) add_part(table, data, part);
  return table;
}

}  // namespace

/// Scores of predictions by the samples of a posterior together, of the prior and of single
/// parameter vectors.
TableEntry scores_table() { return {"scores", Section::fit, has_scores_table, make_scores_table}; }

}  // namespace npdr::pipeline
