#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/normal.h"
#include "core/text.h"
#include "inference/prior.h"
#include "inference/samplers/chain_diagnostics.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/findings/probe.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/report/parts.h"

namespace npdr::pipeline {
namespace {

bool evaluates_rounds(const ReportData& data) {
  const EvaluateConfig& evaluate = data.plan.study.evaluate;
  return has_posteriors(data) && evaluate.rounds == EvaluatedRounds::all &&
         !evaluate.metrics.empty();
}

// Adds a column for each round of the method that has the most, "round 1", with `cell`(round,
// item).
template <class Item, class CellOf>
void add_rounds(const ReportData& data, TableOf<Item>& table, const CellOf& cell) {
  Index most = 0;
  for (const EvaluatedRun& run : data.runs) most = std::max(most, run.use.round);
  for (Index round = 1; round <= most; ++round) {
    table.add("round " + std::to_string(round),
              [round, cell](const Item& item) { return cell(round, item); });
  }
}

struct DensityRow {
  std::string method;
  KnownPoint point;
};

// Of the truth and references; of nominal parameters where there is neither.
std::vector<DensityRow> density_rows(const ReportData& data) {
  std::vector<KnownPoint> points = known_points(data);
  if (points.size() > 1 && data.plan.source->has_nominal()) points.erase(points.begin());
  std::vector<DensityRow> rows;
  for (const KnownPoint& point : points) {
    for (const std::string& method : data.methods) rows.push_back({method, point});
  }
  return rows;
}

Cell density_cell(const std::vector<const EvaluatedRun*>& runs, const DensityRow& row) {
  if (runs.empty()) return {};
  const analysis::Summary summary = analysis::summarize(
      each(runs, [&](const EvaluatedRun* run) { return row.point.log_prob(run->evaluation); }));
  if (summary.n == 0) return "outside";
  Cell cell(summary);
  if (summary.n_failed > 0) {
    cell.notes.push_back(
        fmt::format("of {} seeds only: to the others the point is impossible", summary.n));
  }
  return cell;
}

Cell prior_cell(const ReportData& data, const DensityRow& row) {
  const ParameterMap& parameters = data.plan.source->parameters();
  const Vector theta = parameters.pick_one(parameters.nominal(row.point.parameters));
  const double log_prob = inference::Prior(data.plan.study.prior).log_prob(theta.transpose())(0);
  return std::isfinite(log_prob) ? Cell(log_prob) : Cell("outside");
}

constexpr Index kMostProposed = 10'000;  // of a proposal, all of them draws of the same

// Parameters (n, D) that a round of a method has simulated, of all seeds; of an outer loop in its
// last iteration.
RowMatrix proposals_of(const ReportData& data, const MethodConfig& method, Index round) {
  const Index last_iteration = data.plan.study.num_iterations_of(method);
  RowMatrix all(0, std::ssize(data.plan.study.prior));
  for (const Node& node : data.plan.nodes) {
    const bool is_its = std::ranges::any_of(node.uses, [&](const Use& use) {
      const bool is_last = use.iteration == 0 || use.iteration == last_iteration;
      return use.method == method.name && use.round == round && use.fold == 0 && is_last;
    });
    if (node.stage != Stage::propose || !is_its || !is_complete(data.plan, node)) continue;
    const h5::Dataset theta = open_proposal(node);
    const RowMatrix rows = read_proposal(theta, {0, std::min(kMostProposed, theta.num_rows())});
    all.conservativeResize(all.rows() + rows.rows(), Eigen::NoChange);
    all.bottomRows(rows.rows()) = rows;
  }
  return all;
}

// Intervals of the prior, or of what a round has simulated, of each parameter.
struct ProposalRow {
  std::string label;
  std::vector<std::string> intervals;
};

ProposalRow prior_row(const ReportData& data) {
  ProposalRow row{"prior", {}};
  for (const inference::Marginal& marginal : data.plan.study.prior) {
    const Eigen::Vector2d u(normal_quantile(0.05), normal_quantile(0.95));
    const RowMatrix theta = inference::Prior({marginal}).to_theta(u);
    row.intervals.push_back(interval_text(theta(0, 0), theta(1, 0)));
  }
  return row;
}

std::vector<ProposalRow> proposal_rows(const ReportData& data) {
  std::vector<ProposalRow> rows = {prior_row(data)};
  for (const std::string& name : data.methods) {
    const MethodConfig& method = data.plan.study.method(name);
    for (Index round = 2; round <= method.algorithm.num_rounds; ++round) {
      const RowMatrix theta = proposals_of(data, method, round);
      if (theta.rows() == 0) continue;  // no longer there
      ProposalRow& row = rows.emplace_back(ProposalRow{fmt::format("{}, {}", name, round), {}});
      for (const auto& column : theta.colwise()) row.intervals.push_back(interval_text(column));
    }
  }
  return rows;
}

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

/// One row a method, one column a round: RMSE, or the first metric of the study.
std::optional<Table> rounds_table(const ReportData& data) {
  if (!evaluates_rounds(data)) return std::nullopt;
  const auto& metrics = data.plan.study.evaluate.metrics;
  const bool has_rmse = std::ranges::count(metrics, Metric::rmse) > 0;
  const std::string metric = name_of(has_rmse ? Metric::rmse : metrics.front());
  TableOf<std::string> table{
      .caption = title_of(data, metric) + " of posterior samples after each round, all seeds.",
      .row_header = "Method",
      .rows = data.methods,
      .label = std::identity()};
  add_rounds(data, table, [&](Index round, const std::string& method) {
    const auto runs = data.runs_of(method, round);
    return runs.empty() ? Cell()
                        : cell_of(analysis::summarize(pooled(runs, metric_samples(metric))));
  });
  return table.make();
}

/// One row a method and point (truth, references; nominal parameters where there is neither), one
/// column a round: log p of the posterior [nats], mean and standard deviation over the seeds,
/// beside that of the prior.
std::optional<Table> densities_table(const ReportData& data) {
  TableOf<DensityRow> table{
      .caption =
          "log p of known or measured parameters after each round, in nats: mean and "
          "standard deviation over the seeds.",
      .row_header = "Method, parameters",
      .rows = density_rows(data),
      .label = [](const DensityRow& row) { return row.method + ", " + row.point.name; },
      .last_notes = density_notes(data)};
  if (!evaluates_rounds(data) || table.rows.empty()) return std::nullopt;
  table.add("prior", [&](const DensityRow& row) { return prior_cell(data, row); });
  add_rounds(data, table, [&](Index round, const DensityRow& row) {
    return density_cell(data.runs_of(row.method, round), row);
  });
  return table.make();
}

/// One row a method and round beyond the first, one column a parameter.
std::optional<Table> proposals_table(const ReportData& data) {
  const auto has_rounds = [&](const std::string& method) {
    return data.plan.study.method(method).algorithm.num_rounds > 1;
  };
  if (std::ranges::none_of(data.methods, has_rounds)) return std::nullopt;
  TableOf<ProposalRow> table{
      .caption =
          "Where rounds have simulated: 5 % and 95 % quantiles of their proposals, all "
          "seeds. Round 1 draws from the prior, each further one where the posterior of "
          "the round before it is.",
      .row_header = "Method, round",
      .rows = proposal_rows(data),
      .label = &ProposalRow::label};
  for (std::size_t d = 0; d < data.plan.study.prior.size(); ++d) {
    table.add(data.plan.study.prior[d].name,
              [d](const ProposalRow& row) { return row.intervals[d]; });
  }
  return table.make();
}

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
  add("search", [](const Certificate& certificate) { return words_of(certificate.searched); });
  // In the words of the check of that name, which tells nothing of simulator and noise.
  table.add("Sampling", [&data](const EvaluatedRun* run) -> Cell {
    const auto faults = faults_of(MethodResults(data, run->use.method), *run);
    return faults.empty() ? "passes" : "FAILS: " + join(faults);
  });
  return table.make();
}

}  // namespace npdr::pipeline
