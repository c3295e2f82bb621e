#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

constexpr double kLargestParetoK = 0.7;
constexpr double kLargestDifference = 4.0;  // of the halves: passed by chance with p = 6e-5

// Faults of the draws, in words; "holds": there are none.
std::string verdict(const inference::ImportanceCertificate& certificate,
                    const inference::ImportanceConfig& wanted) {
  std::vector<std::string> faults;
  if (certificate.power < wanted.likelihood_power && !wanted.cross_validate) {
    faults.push_back(
        fmt::format("power {:.3g}, not {:.3g}", certificate.power, wanted.likelihood_power));
  }
  if (certificate.ess < wanted.min_ess) faults.emplace_back("too few effective draws");
  if (!(certificate.pareto_k <= kLargestParetoK)) faults.emplace_back("heavy weights");
  if (!(std::abs(certificate.half_difference) <= kLargestDifference)) {
    faults.emplace_back("halves differ");
  }
  return faults.empty() ? "holds" : "FAILS: " + join(faults);
}

bool exists(const ReportData& data) {
  return std::ranges::any_of(
      data.runs, [](const EvaluatedRun& run) { return run.notes.certificate.has_value(); });
}

Row row_of(const ReportData& data, const EvaluatedRun& run) {
  const inference::ImportanceCertificate& certificate = *run.notes.certificate;
  const MethodConfig& method = data.plan.study.method(run.use.method);
  return {experiment_label(run.use.method, run.use.seed),
          {analysis::MeanStd{certificate.log_evidence, certificate.log_evidence_error, 0},
           certificate.ess, certificate.efficiency, certificate.pareto_k, certificate.power,
           certificate.num_draws, verdict(certificate, method.refine.sampling)}};
}

Table make(const ReportData& data) {
  Table table = empty_table(
      "Refined posteriors: how much their weighted draws are worth. log Z: evidence of the "
      "recording, in nats, and its standard error; of two priors or noise models the one whose log "
      "Z is larger by 3 explains it 20 times better.",
      "Method, seed",
      {"log Z", "ESS", "efficiency", "Pareto k", "power", "simulations", "verdict"});
  for (const std::string& method : data.methods) {
    for (const EvaluatedRun* run : data.runs_of(method)) {
      if (run->notes.certificate) table.rows.push_back(row_of(data, *run));
    }
  }
  return table;
}

}  // namespace

/// One row a refined method and seed: evidence, effective size and tail of the weights.
TableEntry refinement_table() { return {"refinement", Section::posteriors, exists, make}; }

}  // namespace npdr::pipeline
