#include <fmt/format.h>

#include <algorithm>

#include "core/constants.h"
#include "pipeline/report/parts.h"

namespace npdr::pipeline {
namespace {

using Scores = std::vector<const PredictionScores*>;

// Rollouts that are scored: the end of their rows' labels, and the scores of a run and of a
// baseline, which may have none.
struct Part {
  std::string where;
  std::function<Scores(const EvaluatedRun&)> of_run;
  std::optional<PredictionScores> RolloutScores::*of_baseline;
};

// A number that predictions are scored by, and its best value.
struct Score {
  std::string name;
  std::optional<double> ideal;
  std::function<double(const PredictionScores&)> number;
};

// Predictions with observation noise, or without.
struct ScoredStates {
  const char* name;
  Vector PredictionScores::*crps;
  RowMatrix PredictionScores::*coverage;
};
constexpr ScoredStates kWithoutNoise = {"", &PredictionScores::crps, &PredictionScores::coverage};
constexpr ScoredStates kWithNoise = {" with noise", &PredictionScores::noisy_crps,
                                     &PredictionScores::noisy_coverage};

bool is_noisy(const ReportData& data) { return !data.plan.study.observation_noise.is_silent(); }

// Those that are like what is observed.
const ScoredStates& observed_states(const ReportData& data) {
  return is_noisy(data) ? kWithNoise : kWithoutNoise;
}

Score mean_crps(const ScoredStates& states) {
  return {fmt::format("CRPS{}", states.name), -kInfinity,
          [crps = states.crps](const PredictionScores& s) { return (s.*crps).mean(); }};
}

Score share_in_bands(double level, const ScoredStates& states) {
  const Index row = std::ranges::find(kBandLevels, level) - kBandLevels.begin();
  return {fmt::format("{:.0f} % bands{} cover", 100.0 * level, states.name), level,
          [coverage = states.coverage, row](const PredictionScores& s) {
            return (s.*coverage).row(row).mean();
          }};
}

bool has_log_score(const ReportData& data, const Part& part) {
  return std::ranges::all_of(data.runs, [&](const EvaluatedRun& run) {
    return part.of_run(run).front()->log_score.size() > 0;
  });
}

std::vector<Score> main_scores(const ReportData& data, const Part& part) {
  std::vector<Score> scores = {mean_crps(observed_states(data))};
  if (has_log_score(data, part)) {
    scores.push_back(
        {"log score", kInfinity, [](const PredictionScores& s) { return s.log_score.mean(); }});
  }
  scores.push_back(share_in_bands(0.9, observed_states(data)));
  return scores;
}

// All that the main ones leave out.
std::vector<Score> further_scores(const ReportData& data, const Part& /*part*/) {
  std::vector<Score> scores = {share_in_bands(0.5, observed_states(data))};
  if (is_noisy(data)) {
    scores.push_back(mean_crps(kWithoutNoise));
    for (const double level : {0.5, 0.9}) {
      scores.push_back(share_in_bands(level, kWithoutNoise));
      // Of a noisy recording the level is no ideal.
      if (!noiseless_bands_text(data.plan.study).empty()) scores.back().ideal.reset();
    }
  }
  Index c = 0;
  for (const Channel& channel : data.info.state_channels) {
    scores.push_back({"CRPS of " + channel.label, -kInfinity,
                      [c](const PredictionScores& s) { return s.crps(c); }});
    ++c;
  }
  return scores;
}

// A score of the rollouts of a part.
struct ScoreRow {
  Part part;
  Score score;

  Cell of_runs(const std::vector<const EvaluatedRun*>& runs) const {
    const Vector of_seeds = each(runs, [&](const EvaluatedRun* run) {
      return each(part.of_run(*run), [&](const auto* s) { return score.number(*s); }).mean();
    });
    // A log score of what was held to be impossible; summaries are of finite numbers.
    if (of_seeds.size() > 0 && of_seeds.minCoeff() == -kInfinity) return "-inf";
    return cell_of_seeds(analysis::summarize(of_seeds));
  }

  Cell of_baseline(const RolloutScores& scores) const {
    return part.of_baseline == nullptr ? Cell() : Cell(score.number(*(scores.*part.of_baseline)));
  }
};

// The rollouts that were seen, left out and held out.
std::vector<Part> parts_of(const ReportData& data) {
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
  std::vector<Part> parts = {{"", of_run(&RolloutScores::seen), &RolloutScores::seen}};
  if (!data.folds.empty()) parts.push_back({", left out", of_folds, nullptr});
  if (data.held_out) {
    parts.push_back({", held out", of_run(&RolloutScores::held_out), &RolloutScores::held_out});
  }
  return parts;
}

// The scores of every part that `scores_of` chooses.
Table table_of_scores(const ReportData& data, std::string caption,
                      std::vector<Score> (*scores_of)(const ReportData&, const Part&)) {
  std::vector<ScoreRow> rows;
  for (const Part& part : parts_of(data)) {
    for (const Score& score : scores_of(data, part)) rows.push_back({part, score});
  }
  TableOf<ScoreRow> table{
      .caption = std::move(caption),
      .row_header = "Score",
      .rows = std::move(rows),
      .label = [](const ScoreRow& row) { return row.score.name + row.part.where; },
      .ideal = [](const ScoreRow& row) { return row.score.ideal; }};
  for (const std::string& method : data.methods) {
    table.add_compared(
        method, [runs = data.runs_of(method)](const ScoreRow& row) { return row.of_runs(runs); });
  }
  if (data.baseline.prior) {
    table.add("prior",
              [&](const ScoreRow& row) { return row.of_baseline(data.baseline.prior->scores); });
  }
  for (const BaselinePoint& point : data.baseline.points) {
    table.add(point.name, [&](const ScoreRow& row) { return row.of_baseline(point.scores); });
  }
  return table.make();
}

std::string words_on_parts(const ReportData& data) {
  if (data.folds.empty()) return "";
  return fmt::format(
      " Left out: the rollouts are divided into {} parts, and each part is predicted by a "
      "posterior "
      "that has not seen this part. Left-out scores are means over the parts.",
      data.plan.study.evaluate.leave_out);
}

}  // namespace

/// Scores of predictions by the samples of a posterior together, of the prior and of single
/// parameter vectors: of states as they are observed, mean over channels.
std::optional<Table> scores_table(const ReportData& data) {
  if (!has_rollout_scores(data)) return std::nullopt;
  std::string caption =
      "How well the samples of a posterior together predict the stored states. Scores are means "
      "over channels, with mean and standard deviation over seeds. The CRPS (continuous ranked "
      "probability score) "
      "is an error in units of the channel's largest recorded magnitude. A smaller CRPS is better. "
      "A 90 % band should contain 90 % of the recorded states.";
  if (is_noisy(data)) caption += " With noise: the observation noise is added to predictions.";
  if (has_log_score(data, parts_of(data).front())) {
    caption +=
        " The log score is the log density of the recorded states in the same units [nats]. A "
        "larger log score is better.";
  }
  return table_of_scores(data, caption + words_on_parts(data), main_scores);
}

/// The same with other bands, without noise, and channel by channel.
std::optional<Table> scores_details_table(const ReportData& data) {
  if (!has_rollout_scores(data)) return std::nullopt;
  return table_of_scores(data,
                         "Further scores of the same predictions, and the CRPS of each channel. A "
                         "50 % band should contain 50 % of the recorded states." +
                             noiseless_bands_text(data.plan.study) + words_on_parts(data),
                         further_scores);
}

}  // namespace npdr::pipeline
