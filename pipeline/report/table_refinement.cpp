#include <algorithm>

#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

bool has_refinement_table(const ReportData& data) {
  return std::ranges::any_of(
      data.runs, [](const EvaluatedRun& run) { return run.notes.certificate.has_value(); });
}

Row row_of(const EvaluatedRun& run) {
  const inference::ImportanceCertificate& certificate = *run.notes.certificate;
  return {experiment_label(run.use.method, run.use.seed),
          {analysis::MeanStd{certificate.log_evidence, certificate.log_evidence_error, 0},
           certificate.ess, certificate.efficiency, certificate.missed_share, certificate.pareto_k,
           certificate.power, certificate.num_draws, inference::verdict(certificate)}};
}

Table make_refinement_table(const ReportData& data) {
  Table table = empty_table(
      "Refined posteriors: how much their weighted draws are worth. log Z: evidence of the "
      "recording, in nats, and its standard error, where the power of the likelihood is 1; of two "
      "priors or noise models the one whose log Z is larger by 3 explains it 20 times better. At "
      "another power it compares with nothing.",
      "Method, seed",
      {"log Z", "ESS", "efficiency", "missed", "Pareto k", "power", "simulations", "verdict"});
  for (const std::string& method : data.methods) {
    for (const EvaluatedRun* run : data.runs_of(method)) {
      if (run->notes.certificate) table.rows.push_back(row_of(*run));
    }
  }
  return table;
}

}  // namespace

/// One row a refined method and seed: evidence, effective size and tail of the weights.
TableEntry refinement_table() {
  return {"refinement", Section::diagnostics, has_refinement_table, make_refinement_table};
}

}  // namespace npdr::pipeline
