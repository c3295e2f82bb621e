#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {

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
