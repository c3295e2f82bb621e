#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/constants.h"
#include "core/quantile.h"
#include "pipeline/features/observation.h"
#include "pipeline/report/parts.h"
#include "sim/noise_transform.h"

namespace npdr::pipeline {
namespace {

// A parameter of the noise: its prior, a value, and what was inferred.
struct NoiseParameterOf {
  const char* name;
  sim::NoiseParameter sim::ChannelNoise::*prior;
  double sim::NoiseValues::*value;
  RowMatrix InferredNoise::*inferred;
};
constexpr NoiseParameterOf kNoiseParameters[] = {
    {"scale", &sim::ChannelNoise::scale, &sim::NoiseValues::scale, &InferredNoise::scale},
    {"correlation", &sim::ChannelNoise::correlation, &sim::NoiseValues::correlation,
     &InferredNoise::correlation},
    {"degrees of freedom", &sim::ChannelNoise::degrees_of_freedom,
     &sim::NoiseValues::degrees_of_freedom, &InferredNoise::degrees_of_freedom}};

// One of a channel.
struct NoiseRow {
  std::string label;
  NoiseParameterOf parameter;
  Index c;
  sim::ChannelNoise noise;
};

// Those that have priors.
std::vector<NoiseRow> noise_rows(const ReportData& data) {
  const sim::NoiseModel model = noise_model(data.plan.study, data.target);
  std::vector<NoiseRow> rows;
  for (const NoiseParameterOf& parameter : kNoiseParameters) {
    for (Index c = 0; c < model.num_states(); ++c) {
      const auto channel = static_cast<std::size_t>(c);
      const sim::ChannelNoise& noise = model.channels()[channel];
      if (!(noise.*parameter.prior).is_unknown() || !model.has_density(c)) continue;
      rows.push_back(
          {fmt::format("{} of {}", parameter.name, data.info.state_channels[channel].label),
           parameter, c, noise});
    }
  }
  return rows;
}

std::string around(double median, double low, double high) {
  return fmt::format("{:.3g} ({:.3g} to {:.3g})", median, low, high);
}

std::string prior_of_noise(const NoiseRow& row) {
  const sim::NoiseTransform transform(row.noise);
  const auto at = [&](double z) {
    return transform.values(Vector::Constant(transform.dimension(), z)).*row.parameter.value;
  };
  return around(at(0.0), at(-1.0), at(1.0));
}

// By what a refinement that chose its power has multiplied the scales; "" for others.
std::string note_on_factor(const std::vector<const EvaluatedRun*>& runs) {
  double smallest = kInfinity, largest = 0.0;
  for (const EvaluatedRun* run : runs) {
    if (!run->notes.certificate) return "";
    const double factor = run->notes.powers.noise_factor_at(run->notes.certificate->power);
    smallest = std::min(smallest, factor);
    largest = std::max(largest, factor);
  }
  if (smallest == 1.0 && largest == 1.0) return "";
  return fmt::format("{:.2g}", smallest) +
         (smallest < largest ? fmt::format(" to {:.2g}", largest) : "") +
         " times the scale of what its parameters leave: so much noise predicts left-out rollouts "
         "best, or hardly worse with bands that hold more nearly what they should";
}

// Median and central 68 % of all seeds' samples.
Cell inferred_cell(const std::vector<const EvaluatedRun*>& runs, const NoiseRow& row) {
  const Vector samples = pooled(runs, [&](const EvaluatedRun* run) -> Vector {
    return ((*run->evaluation.noise).*row.parameter.inferred).col(row.c);
  });
  const analysis::Summary summary = analysis::summarize(samples);
  const std::vector<double> sorted = sorted_finite(samples);
  const auto quantile = [&](double p) { return quantile_of_sorted(sorted, p); };
  Cell cell = sorted.empty() ? Cell() : Cell(around(quantile(0.5), quantile(0.16), quantile(0.84)));
  cell = with_failed(cell, summary);
  const std::string note = note_on_factor(runs);
  if (row.parameter.inferred == &InferredNoise::scale && !note.empty()) cell.notes.push_back(note);
  return cell;
}

}  // namespace

/// Parameters of the observation noise that have priors: these, and what was inferred. One row for
/// each of a channel.
std::optional<Table> noise_table(const ReportData& data) {
  const auto has_noise = [](const EvaluatedRun& run) { return run.evaluation.noise.has_value(); };
  if (std::ranges::none_of(data.runs, has_noise)) return std::nullopt;
  TableOf<NoiseRow> table{
      .caption =
          "Inferred observation noise: median and 16 % to 84 % of the noise that each method's "
          "predictions are given, all seeds. Scale: of a stored state, or where noise is "
          "correlated of what is new in it, over the channel's largest recorded magnitude; "
          "correlation: of "
          "neighboring stored states' noise. What a method's parameters leave unexplained counts "
          "as noise.",
      .row_header = "Noise",
      .rows = noise_rows(data),
      .label = &NoiseRow::label};
  table.add("prior", prior_of_noise);
  table.add_each(data.methods, [&](const std::string& method, const NoiseRow& row) {
    return inferred_cell(data.runs_of(method), row);
  });
  return table.make();
}

}  // namespace npdr::pipeline
