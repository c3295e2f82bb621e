#include <fmt/format.h>

#include <algorithm>

#include "core/constants.h"
#include "inference/samplers/chain_diagnostics.h"
#include "pipeline/report/parts.h"

namespace npdr::pipeline {
namespace {

// A row for each method and seed.
TableOf<const EvaluatedRun*> table_of_runs(const ReportData& data, std::string caption) {
  std::vector<const EvaluatedRun*> runs;
  for (const std::string& method : data.methods) {
    for (const EvaluatedRun* run : data.runs_of(method)) runs.push_back(run);
  }
  return {.caption = std::move(caption),
          .row_header = "Method, seed",
          .rows = std::move(runs),
          .label = [](const EvaluatedRun* run) {
            return fmt::format("{}, {}", run->use.method, run->use.seed);
          }};
}

// The worst of all parameters; NaN, in which chains were too short to say, is worst.
Cell worst(const Vector& values, double sign) {
  if (values.size() == 0) return {};
  if (values.hasNaN()) return kNaN;
  return sign * (sign * values).maxCoeff();
}

// With what to do about chains that are too short to say, or that don't agree.
Cell r_hat_cell(const Vector& r_hat) {
  Cell cell = worst(r_hat, 1.0);
  if (r_hat.size() == 0) return cell;
  if (r_hat.hasNaN()) {
    cell.notes.emplace_back(
        "fewer than four draws of each chain say nothing: raise evaluate.num_samples, or for ABC "
        "the rounds");
  } else if (r_hat.maxCoeff() > inference::kLargestRHat) {
    cell.notes.emplace_back(
        "chains don't agree: raise sampler.num_warmup; where modes lie apart, which no chain "
        "crosses, sampler.num_candidates and num_chains; for ABC the rounds");
  }
  return cell;
}

Cell likelihood_power_cell(const PoolNotes& pool) {
  Cell cell(pool.powers_at_x_o.likelihood);
  if (pool.powers_at_x_o != pool.powers) {
    cell.notes.push_back(fmt::format("{:.3g} and {:.3g} among held-out simulations",
                                     pool.powers.posterior, pool.powers.likelihood));
  }
  return cell;
}

Cell epochs_cell(const PosteriorNotes& notes) {
  Index epochs = 0;
  for (const auto* losses : {&notes.losses, &notes.likelihood_losses}) {
    for (const TrainingLosses& network : *losses) epochs += network.training.size();
  }
  return epochs > 0 ? Cell(epochs) : Cell();
}

}  // namespace

/// One row a method and seed: fit, densities, simulations, epochs, chains.
std::optional<Table> seeds_table(const ReportData& data) {
  if (!has_posteriors(data)) return std::nullopt;
  using Run = const EvaluatedRun*;
  auto table = table_of_runs(data, "Each experiment. log p: posterior density in nats.");
  table.first_notes = density_notes(data);
  for (const std::string& metric : to_names(data.plan.study.evaluate.metrics)) {
    const std::string title = title_of(data, metric);
    table.add(title, [metric](Run run) {
      return cell_of(analysis::summarize(run->evaluation.metrics.at(metric)));
    });
    table.add(title + " of MAP",
              [metric](Run run) { return run->evaluation.map_metrics.at(metric); });
  }
  for (const KnownPoint& point : known_points(data)) {
    table.add(fmt::format("log p({})", point.name),
              [log_prob = point.log_prob](Run run) { return log_prob(run->evaluation); });
  }
  table.add("simulations", [](Run run) { return run->notes.rows.used + run->notes.rows.failed; });
  table.add("failed", [](Run run) { return run->notes.rows.failed; });
  table.add("epochs", [](Run run) { return epochs_cell(run->notes); });
  const auto add_where = [&](const auto& part_of, const char* title, const auto& cell) {
    if (std::ranges::none_of(data.runs, [&](const auto& run) { return part_of(&run).has_value(); }))
      return;
    table.add(title, [part_of, cell](Run run) {
      return part_of(run) ? Cell(cell(*part_of(run))) : Cell();
    });
  };
  const auto sampler = [](Run run) -> const auto& { return run->evaluation.sampler; };
  add_where(sampler, "largest R-hat", [](const auto& s) { return r_hat_cell(s.r_hat); });
  add_where(sampler, "smallest ESS", [](const auto& s) { return worst(s.ess, -1.0); });
  const auto pool = [](Run run) -> const auto& { return run->notes.pool; };
  add_where(pool, "power of NPE", [](const auto& p) { return p.powers_at_x_o.posterior; });
  add_where(pool, "power of NLE", likelihood_power_cell);
  return table.make();
}

/// One row a refined method and seed: evidence, effective size and tail of the weights.
std::optional<Table> refinement_table(const ReportData& data) {
  auto table = table_of_runs(
      data,
      "Refined posteriors: how much their weighted draws are worth. log Z: evidence of the "
      "recording, in nats, and its standard error, where the power of the likelihood is 1; of two "
      "priors or noise models the one whose log Z is larger by 3 explains it 20 times better. At "
      "another power it compares with nothing.");
  std::erase_if(table.rows, [](const EvaluatedRun* run) { return !run->notes.certificate; });
  if (table.rows.empty()) return std::nullopt;
  using Certificate = inference::ImportanceCertificate;
  const auto add = [&](const char* title, const auto& cell) {
    table.add(title, [cell](const EvaluatedRun* run) -> Cell {
      return std::invoke(cell, *run->notes.certificate);
    });
  };
  add("log Z", [](const Certificate& certificate) {
    return analysis::MeanStd{certificate.log_evidence, certificate.log_evidence_error, 0};
  });
  add("ESS", &Certificate::ess);
  add("efficiency", &Certificate::efficiency);
  add("missed", &Certificate::missed_share);
  add("Pareto k", &Certificate::pareto_k);
  add("power", &Certificate::power);
  add("simulations", &Certificate::num_draws);
  add("verdict", [](const Certificate& certificate) { return inference::verdict(certificate); });
  return table.make();
}

}  // namespace npdr::pipeline
