#include <fmt/format.h>

#include <algorithm>

#include "core/constants.h"
#include "inference/samplers/chain_diagnostics.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

bool any_was_sampled(const ReportData& data) {
  return std::ranges::any_of(
      data.runs, [](const EvaluatedRun& run) { return run.evaluation.sampler.has_value(); });
}

// The worst of all parameters; NaN, in which chains were too short to say, is worst.
Cell worst(const Vector& values, double sign) {
  if (values.size() == 0) return {};
  if (values.hasNaN()) return kNaN;
  return sign * (sign * values).maxCoeff();
}

// Chains that are too short to say, or that don't agree.
void note_chains(const EvaluatedRun& run, Cell& cell, Table& table) {
  const Vector& r_hat = run.evaluation.sampler->r_hat;
  if (r_hat.size() == 0) return;
  if (r_hat.hasNaN()) {
    cell.notes.push_back(
        table.footnote("fewer than four draws of each chain say nothing: raise "
                       "evaluate.num_samples, or for ABC the rounds"));
  } else if (r_hat.maxCoeff() > inference::kLargestRHat) {
    cell.notes.push_back(table.footnote(
        "chains don't agree: raise sampler.num_warmup; where modes lie apart, which no chain "
        "crosses, sampler.num_candidates and num_chains; for ABC the rounds"));
  }
}

void add_sampler_cells(const EvaluatedRun& run, Row& row, Table& table) {
  const auto& sampler = run.evaluation.sampler;
  row.cells.push_back(sampler ? worst(sampler->r_hat, 1.0) : Cell());
  if (sampler) note_chains(run, row.cells.back(), table);
  row.cells.push_back(sampler ? worst(sampler->ess, -1.0) : Cell());
}

bool any_was_pooled(const ReportData& data) {
  return std::ranges::any_of(data.runs,
                             [](const EvaluatedRun& run) { return run.notes.pool.has_value(); });
}

void add_pool_cells(const EvaluatedRun& run, Row& row, Table& table) {
  if (!run.notes.pool) {
    row.cells.resize(row.cells.size() + 2);
    return;
  }
  const inference::PoolPowers& wanted = run.notes.pool->powers;
  const inference::PoolPowers& powers = run.notes.pool->powers_at_x_o;
  row.cells.emplace_back(powers.posterior);
  row.cells.emplace_back(powers.likelihood);
  if (powers == wanted) return;
  row.cells.back().notes.push_back(table.footnote(fmt::format(
      "{:.3g} and {:.3g} among held-out simulations", wanted.posterior, wanted.likelihood)));
}

// Columns that not every study has.
struct Columns {
  bool has_nominal;
  bool has_truth;
  bool has_sampler;
  bool has_pool;
};

void add_seed_columns(const ReportData& data, const Columns& has, Table& table) {
  for (const std::string& metric : to_names(data.plan.study.evaluate.metrics)) {
    add_columns(table, {title_of(data, metric), title_of(data, metric) + " of MAP"});
  }
  if (has.has_nominal) add_columns(table, {"log p(nominal)"});
  if (has.has_truth) add_columns(table, {"log p(truth)"});
  for (const ReferenceConfig& reference : data.plan.study.references) {
    add_columns(table, {fmt::format("log p({})", reference.name)});
  }
  add_columns(table, {"simulations", "failed", "epochs"});
  if (has.has_sampler) add_columns(table, {"largest R-hat", "smallest ESS"});
  if (has.has_pool) add_columns(table, {"power of NPE", "power of NLE"});
}

Row row_of(const ReportData& data, const EvaluatedRun& run, const Columns& has, Table& table) {
  const Evaluation& evaluation = run.evaluation;
  Row row{experiment_label(run.use.method, run.use.seed), {}};
  for (const std::string& metric : to_names(data.plan.study.evaluate.metrics)) {
    row.cells.push_back(cell_of(table, analysis::summarize(evaluation.metrics.at(metric))));
    row.cells.emplace_back(evaluation.map_metrics.at(metric));
  }
  if (has.has_nominal) row.cells.emplace_back(*evaluation.nominal_log_prob);
  if (has.has_truth) row.cells.emplace_back(*evaluation.truth_log_prob);
  for (const ReferenceConfig& reference : data.plan.study.references) {
    row.cells.emplace_back(evaluation.reference_log_prob.at(reference.name));
  }
  row.cells.emplace_back(run.notes.rows.used + run.notes.rows.failed);
  row.cells.emplace_back(run.notes.rows.failed);
  Index epochs = 0;
  for (const auto* losses : {&run.notes.losses, &run.notes.likelihood_losses}) {
    for (const TrainingLosses& network : *losses) epochs += network.training.size();
  }
  row.cells.push_back(epochs > 0 ? Cell(epochs) : Cell());
  if (has.has_sampler) add_sampler_cells(run, row, table);
  if (has.has_pool) add_pool_cells(run, row, table);
  return row;
}

Table make_seeds_table(const ReportData& data) {
  Table table =
      empty_table("Each experiment. log p: posterior density in nats.", "Method, seed", {});
  const Columns has{data.plan.source->has_nominal(), data.plan.study.target.truth.has_value(),
                    any_was_sampled(data), any_was_pooled(data)};
  add_seed_columns(data, has, table);
  note_fixed_parameters(table, data);
  note_known_parameters(table, data);
  for (const std::string& method : data.methods) {
    for (const EvaluatedRun* run : data.runs_of(method)) {
      table.rows.push_back(row_of(data, *run, has, table));
    }
  }
  return table;
}

}  // namespace

/// One row a method and seed: fit, densities, simulations, epochs, chains.
TableEntry seeds_table() { return {"seeds", Section::details, has_posteriors, make_seeds_table}; }

}  // namespace npdr::pipeline
