#include <fmt/format.h>

#include <algorithm>

#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

using OfRun = std::optional<PredictionScores> Evaluation::*;

bool exists(const ReportData& data) {
  return std::ranges::any_of(
      data.runs, [](const EvaluatedRun& run) { return run.evaluation.scores.has_value(); });
}

bool has_noise(const ReportData& data) { return !data.plan.study.observation_noise.is_silent(); }

Index row_of_level(double level) {
  return std::ranges::find(kBandLevels, level) - kBandLevels.begin();
}

// A row with one number a method and seed.
template <class Number>
void add(Table& table, const ReportData& data, const std::string& label, OfRun part,
         const Number& number) {
  add_row(table, label, data.methods, [&](const std::string& method) -> Cell {
    return analysis::summarize(each(data.runs_of(method), [&](const EvaluatedRun* run) {
      return number(*(run->evaluation.*part));
    }));
  });
}

// All rows of the rollouts that were seen, or held out.
void add_part(Table& table, const ReportData& data, OfRun part, const std::string& where) {
  using S = PredictionScores;
  add(table, data, "CRPS" + where, part, [](const S& s) { return s.crps.mean(); });
  if (has_noise(data)) {
    add(table, data, "CRPS with noise" + where, part,
        [](const S& s) { return s.noisy_crps.mean(); });
  }
  if (std::ranges::all_of(data.runs, [part](const EvaluatedRun& run) {
        return (run.evaluation.*part)->log_score.size() > 0;
      })) {
    add(table, data, "log score" + where, part, [](const S& s) { return s.log_score.mean(); });
  }
  for (const double level : {0.5, 0.9}) {
    const Index row = row_of_level(level);
    const std::string bands = fmt::format("{:.0f} % bands cover", 100.0 * level);
    add(table, data, bands + where, part, [row](const S& s) { return s.coverage.row(row).mean(); });
    if (!has_noise(data)) continue;
    add(table, data, bands + ", with noise" + where, part,
        [row](const S& s) { return s.noisy_coverage.row(row).mean(); });
  }
  Index c = 0;
  for (const Channel& channel : data.info.state_channels) {
    add(table, data, fmt::format("CRPS of {}{}", channel.label, where), part,
        [c](const S& s) { return s.crps(c); });
    ++c;
  }
}

Table make(const ReportData& data) {
  Table table = empty_table(
      "How well posterior samples predict the stored states together, and how sure one can be of "
      "it: mean over channels, mean and standard deviation over seeds. CRPS: continuous ranked "
      "probability score over the channel's largest recorded magnitude, smaller is better; log "
      "score: of the density with noise of a state, over the same [nats], larger is better; bands: "
      "share of the recorded states that they hold, best as much as they are called.",
      "Score", data.methods);
  add_part(table, data, &Evaluation::scores, "");
  if (data.held_out) add_part(table, data, &Evaluation::held_out_scores, ", held out");
  return table;
}

}  // namespace

/// Scores of predictions by the samples of a posterior together.
TableEntry scores_table() { return {"scores", Section::predictions, exists, make}; }

}  // namespace npdr::pipeline
