#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "core/constants.h"
#include "core/quantile.h"
#include "pipeline/features/noise.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"
#include "sim/noise_transform.h"

namespace npdr::pipeline {
namespace {

// A parameter of the noise: its prior, a value, and what was inferred.
struct NoiseRow {
  const char* name;
  sim::NoiseParameter sim::ChannelNoise::*prior;
  double sim::NoiseValues::*value;
  RowMatrix InferredNoise::*inferred;
};
constexpr NoiseRow kRows[] = {
    {"scale", &sim::ChannelNoise::scale, &sim::NoiseValues::scale, &InferredNoise::scale},
    {"correlation", &sim::ChannelNoise::correlation, &sim::NoiseValues::correlation,
     &InferredNoise::correlation},
    {"degrees of freedom", &sim::ChannelNoise::degrees_of_freedom,
     &sim::NoiseValues::degrees_of_freedom, &InferredNoise::degrees_of_freedom}};

bool has_noise_table(const ReportData& data) {
  return std::ranges::any_of(
      data.runs, [](const EvaluatedRun& run) { return run.evaluation.noise.has_value(); });
}

std::string around(double median, double low, double high) {
  return fmt::format("{:.3g} ({:.3g} to {:.3g})", median, low, high);
}

std::string prior_text(const sim::ChannelNoise& noise, double sim::NoiseValues::*value) {
  const sim::NoiseTransform transform(noise);
  const auto at = [&](double z) {
    return transform.values(Vector::Constant(transform.dimension(), z)).*value;
  };
  return around(at(0.0), at(-1.0), at(1.0));
}

// Median and central 68 % of all seeds' samples.
Cell inferred_cell(Table& table, const Vector& samples) {
  const analysis::Summary summary = analysis::summarize(samples);
  const std::vector<double> sorted = sorted_finite(samples);
  const auto quantile = [&](double p) { return quantile_of_sorted(sorted, p); };
  Cell cell = sorted.empty() ? Cell() : Cell(around(quantile(0.5), quantile(0.16), quantile(0.84)));
  note_failed(table, cell, summary);
  return cell;
}

// Says by what a refinement that chose its power has multiplied the scales.
void note_factor(Table& table, Cell& cell, const std::vector<const EvaluatedRun*>& runs) {
  double smallest = kInfinity, largest = 0.0;
  for (const EvaluatedRun* run : runs) {
    if (!run->notes.certificate) return;
    const double factor = run->notes.powers.noise_factor_at(run->notes.certificate->power);
    smallest = std::min(smallest, factor);
    largest = std::max(largest, factor);
  }
  if (smallest == 1.0 && largest == 1.0) return;
  std::string factors = fmt::format("{:.2g}", smallest);
  if (smallest < largest) factors += fmt::format(" to {:.2g}", largest);
  cell.notes.push_back(table.footnote(
      factors +
      " times the scale of what its parameters leave: so much noise predicts left-out rollouts "
      "best, or hardly worse with bands that hold more nearly what they should"));
}

// One row a channel with noise whose parameter has a prior.
void add_rows(Table& table, const ReportData& data, const NoiseRow& parameter) {
  const sim::NoiseModel model = noise_model(data.plan.study, data.target);
  for (Index c = 0; c < model.num_states(); ++c) {
    const auto channel = static_cast<std::size_t>(c);
    const sim::ChannelNoise& noise = model.channels()[channel];
    if (!(noise.*parameter.prior).is_unknown() || !model.has_density(c)) continue;
    Row row{fmt::format("{} of {}", parameter.name, data.info.state_channels[channel].label),
            {prior_text(noise, parameter.value)}};
    for (const std::string& method : data.methods) {
      const auto runs = data.runs_of(method);
      row.cells.push_back(
          inferred_cell(table, pooled(runs, [&](const EvaluatedRun* run) -> Vector {
                          return ((*run->evaluation.noise).*parameter.inferred).col(c);
                        })));
      if (parameter.inferred == &InferredNoise::scale) note_factor(table, row.cells.back(), runs);
    }
    table.rows.push_back(std::move(row));
  }
}

Table make_noise_table(const ReportData& data) {
  Table table = empty_table(
      "Inferred observation noise: median and 16 % to 84 % of the noise that each method's "
      "predictions are given, all seeds. Scale: of a stored state, or where noise is correlated "
      "of what is new in it, over the channel's largest recorded magnitude; correlation: of "
      "neighboring stored states' noise. What a method's parameters leave unexplained counts as "
      "noise.",
      "Noise", {"prior"});
  add_columns(table, data.methods);
  for (const NoiseRow& parameter : kRows) add_rows(table, data, parameter);
  return table;
}

}  // namespace

/// Parameters of the observation noise that have priors: these, and what was inferred.
TableEntry noise_table() {
  return {"noise", Section::posteriors, has_noise_table, make_noise_table};
}

}  // namespace npdr::pipeline
