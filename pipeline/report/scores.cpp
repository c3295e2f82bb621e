#include <fmt/format.h>

#include <algorithm>

#include "core/constants.h"
#include "pipeline/report/parts.h"

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

// A number of the rollouts of a part.
struct ScoreRow {
  std::string label;
  Part part;
  std::function<double(const PredictionScores&)> number;

  Cell of_runs(const std::vector<const EvaluatedRun*>& runs) const {
    const Vector of_seeds = each(runs, [&](const EvaluatedRun* run) {
      return each(part.of_run(*run), [&](const PredictionScores* s) { return number(*s); }).mean();
    });
    // A log score of what was held to be impossible; summaries are of finite numbers.
    if (of_seeds.size() > 0 && of_seeds.minCoeff() == -kInfinity) return "-inf";
    return cell_of_seeds(analysis::summarize(of_seeds));
  }

  Cell of_baseline(const RolloutScores& scores) const {
    return part.of_baseline == nullptr ? Cell() : Cell(number(*(scores.*part.of_baseline)));
  }
};

// All rows of the rollouts that were seen, left out or held out.
void add_part(const ReportData& data, const Part& part, std::vector<ScoreRow>& rows) {
  using S = PredictionScores;
  const auto add = [&](const std::string& score, std::function<double(const S&)> number) {
    rows.push_back({score + part.where, part, std::move(number)});
  };
  const bool has_log_score = std::ranges::all_of(data.runs, [&](const EvaluatedRun& run) {
    return part.of_run(run).front()->log_score.size() > 0;
  });
  const bool has_noise = !data.plan.study.observation_noise.is_silent();
  add("CRPS", [](const S& s) { return s.crps.mean(); });
  if (has_noise) add("CRPS with noise", [](const S& s) { return s.noisy_crps.mean(); });
  if (has_log_score) add("log score", [](const S& s) { return s.log_score.mean(); });
  for (const double level : {0.5, 0.9}) {
    const Index row = std::ranges::find(kBandLevels, level) - kBandLevels.begin();
    const std::string bands = fmt::format("{:.0f} % bands cover", 100.0 * level);
    add(bands, [row](const S& s) { return s.coverage.row(row).mean(); });
    if (!has_noise) continue;
    add(bands + ", with noise", [row](const S& s) { return s.noisy_coverage.row(row).mean(); });
  }
  Index c = 0;
  for (const Channel& channel : data.info.state_channels) {
    add("CRPS of " + channel.label, [c](const S& s) { return s.crps(c); });
    ++c;
  }
}

std::vector<ScoreRow> score_rows(const ReportData& data) {
  const auto of_run = [](std::optional<PredictionScores> RolloutScores::*scores) {
    return [scores](const EvaluatedRun& run) { return Scores{&*(run.evaluation.scores.*scores)}; };
  };
  const auto of_folds = [&data](const EvaluatedRun& run) {
    Scores scores;
    for (const EvaluatedRun* fold : data.folds_of(run.use)) {
      scores.push_back(&*fold->evaluation.scores.held_out);
    }
    return scores;
  };
  std::vector<ScoreRow> rows;
  add_part(data, {"", of_run(&RolloutScores::seen), &RolloutScores::seen}, rows);
  if (!data.folds.empty()) add_part(data, {", left out", of_folds, nullptr}, rows);
  if (data.held_out) {
    add_part(data, {", held out", of_run(&RolloutScores::held_out), &RolloutScores::held_out},
             rows);
  }
  return rows;
}

std::string caption_of_scores(const ReportData& data) {
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

}  // namespace

/// Scores of predictions by the samples of a posterior together, of the prior and of single
/// parameter vectors.
std::optional<Table> scores_table(const ReportData& data) {
  if (!has_rollout_scores(data)) return std::nullopt;
  TableOf<ScoreRow> table{.caption = caption_of_scores(data),
                          .row_header = "Score",
                          .rows = score_rows(data),
                          .label = &ScoreRow::label};
  table.add_each(data.methods, [&](const std::string& method, const ScoreRow& row) {
    return row.of_runs(data.runs_of(method));
  });
  if (data.baseline.prior) {
    table.add("prior",
              [&](const ScoreRow& row) { return row.of_baseline(data.baseline.prior->scores); });
  }
  for (const BaselinePoint& point : data.baseline.points) {
    table.add(point.name, [&](const ScoreRow& row) { return row.of_baseline(point.scores); });
  }
  return table.make();
}

}  // namespace npdr::pipeline
