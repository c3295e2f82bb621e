#include <fmt/format.h>

#include <algorithm>

#include "pipeline/features/noise.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"
#include "sim/noise_transform.h"

namespace npdr::pipeline {
namespace {

using Values = RowMatrix NoiseSamples::*;

bool exists(const ReportData& data) {
  return std::ranges::any_of(
      data.runs, [](const EvaluatedRun& run) { return run.evaluation.noise.has_value(); });
}

// The prior's median, and what lies a deviation around it.
std::string prior_text(const sim::ChannelNoise& noise, double sim::NoiseValues::*parameter) {
  const sim::NoiseTransform transform(noise);
  const auto at = [&](double z) {
    return transform.values(Vector::Constant(transform.dimension(), z)).*parameter;
  };
  return fmt::format("{:.3g} ({:.3g} to {:.3g})", at(0.0), at(-1.0), at(1.0));
}

Cell cell_of_samples(const ReportData& data, const std::string& method, Values values, Index c) {
  return analysis::summarize(pooled(data.runs_of(method), [&](const EvaluatedRun* run) -> Vector {
    return ((*run->evaluation.noise).*values).col(c);
  }));
}

// One row a channel whose parameter has a prior.
void add_rows(Table& table, const ReportData& data, const char* name,
              sim::NoiseParameter sim::ChannelNoise::*parameter,
              double sim::NoiseValues::*value_of_prior, Values values) {
  const sim::NoiseModel model = noise_model(data.plan.study, data.target);
  for (Index c = 0; c < model.num_states(); ++c) {
    const auto channel = static_cast<std::size_t>(c);
    const sim::ChannelNoise& noise = model.channels()[channel];
    if (!(noise.*parameter).is_unknown()) continue;
    Row row{fmt::format("{} of {}", name, data.info.state_channels[channel].label),
            {prior_text(noise, value_of_prior)}};
    for (const std::string& method : data.methods) {
      row.cells.push_back(cell_of_samples(data, method, values, c));
    }
    table.rows.push_back(std::move(row));
  }
}

Table make(const ReportData& data) {
  Table table = empty_table(
      "Inferred observation noise: what the recording says of it, given each posterior's samples; "
      "mean and standard deviation, all seeds. Scale: of a stored state, or where noise is "
      "correlated of what is new in it, over the channel's largest recorded magnitude; "
      "correlation: of neighboring stored states' noise. Prior: median, and one deviation around "
      "it.",
      "Noise", {"prior"});
  add_columns(table, data.methods);
  using Noise = sim::ChannelNoise;
  using Drawn = sim::NoiseValues;
  add_rows(table, data, "scale", &Noise::scale, &Drawn::scale, &NoiseSamples::scale);
  add_rows(table, data, "correlation", &Noise::correlation, &Drawn::correlation,
           &NoiseSamples::correlation);
  add_rows(table, data, "degrees of freedom", &Noise::degrees_of_freedom,
           &Drawn::degrees_of_freedom, &NoiseSamples::degrees_of_freedom);
  return table;
}

}  // namespace

/// Parameters of the observation noise that have priors: these, and what was inferred.
TableEntry noise_table() { return {"noise", Section::posteriors, exists, make}; }

}  // namespace npdr::pipeline
