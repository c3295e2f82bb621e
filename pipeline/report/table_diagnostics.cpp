#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "pipeline/features/failures.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

using Runs = std::vector<const ResultOf<Diagnosis>*>;

// Bonferroni over the method's checks that have a p-value, and the seeds.
double level_of(const ReportData& data, const std::string& method, const Runs& runs) {
  const DiagnoseConfig config = data.checks_of(method);
  const auto has_p_value = [](Check check) { return traits_of(check).has_p_value; };
  const auto tests = static_cast<std::size_t>(std::ranges::count_if(config.checks, has_p_value));
  return config.alpha / static_cast<double>(std::max<std::size_t>(tests * runs.size(), 1));
}

std::string seeds_text(std::size_t failed, std::size_t all) {
  return all == 1 ? "" : fmt::format(" in {} of {} seeds", failed, all);
}

Cell training_cell(const Runs& runs) {
  std::size_t failed = 0;
  double gap = 0.0;
  for (const auto* run : runs) {
    const inference::TrainingCheck& check = *run->result.training;
    failed += check.is_converged ? 0 : 1;
    gap += check.generalization_gap / static_cast<double>(runs.size());
  }
  const std::string verdict =
      failed > 0 ? "NOT converged" + seeds_text(failed, runs.size()) : "converged";
  return fmt::format("{}, gap {:.2g} nats", verdict, gap);
}

Cell test_cell(Check check, const Runs& runs, double level) {
  std::size_t failed = 0;
  double smallest = 1.0;
  for (const auto* run : runs) {
    const double p = run->result.p_values().at(name_of(check));
    failed += p < level ? 1 : 0;
    smallest = std::min(smallest, p);
  }
  const char* sign = runs.size() > 1 ? "≥" : "=";
  if (failed == 0) return fmt::format("passes, p {} {:.2g}", sign, smallest);
  return fmt::format("{}{}, p {} {:.2g}", traits_of(check).failure, seeds_text(failed, runs.size()),
                     sign, smallest);
}

Cell check_cell(const ReportData& data, const std::string& method, Check check) {
  if (!data.checks_of(method).has(check)) return {};
  const Runs runs = data.diagnoses_of(method);
  if (!traits_of(check).has_p_value) return training_cell(runs);
  return test_cell(check, runs, level_of(data, method, runs));
}

double times_usual(const inference::Distance& distance) {
  return distance.observed > 0.0 ? distance.observed / distance.median : 0.0;
}

// An observation outside of what was simulated makes all else void: said in a sentence.
void note_outside(const std::string& method, const Runs& runs, double level, Table& table) {
  for (const auto* run : runs) {
    const auto& ood = run->result.ood;
    if (!ood || ood->p_value >= level) continue;
    table.footnote(fmt::format(
        "{}: the observation lies outside of what was simulated (seed {}: {:.3g} times the usual "
        "distance within the simulations' directions, {:.3g} times beyond them, {:.3g} times to "
        "the nearest simulation); the network extrapolates there, whatever the other checks say",
        method, run->use.seed, times_usual(ood->mahalanobis), times_usual(ood->residual),
        times_usual(ood->nearest)));
    return;
  }
}

void note_unpredicted(const std::string& method, const Runs& runs, double level, Table& table) {
  for (const auto* run : runs) {
    const auto& predictive = run->result.predictive;
    if (!predictive || predictive->check.p_value >= level) continue;
    if (predictive->median.hasNaN()) {
      table.footnote(fmt::format(
          "{}: {} of its {} predictions failed (seed {}), too many to compare the others with the "
          "observation; see why in the log of stage diagnose, or in those of its simulations",
          method, predictive->num_failed, run->result.num_samples, run->use.seed));
      return;
    }
    Index worst = 0;
    predictive->check.summary_p_value.minCoeff(&worst);
    table.footnote(fmt::format(
        "{}: what its samples predict is unlike the observation (seed {}): all features together, "
        "p = {:.2g}; of single summaries most {}, observed {:.3g}, predicted median {:.3g}, p = "
        "{:.2g}",
        method, run->use.seed, predictive->check.overall.p_value,
        predictive->names[static_cast<std::size_t>(worst)], predictive->observed(worst),
        predictive->median(worst), predictive->check.summary_p_value(worst)));
    return;
  }
}

void note_failures(const std::string& method, const Runs& runs, double level, Table& table) {
  for (const auto* run : runs) {
    const auto& failures = run->result.failures;
    if (!failures || failures->test.p_value >= level) continue;
    table.footnote(fmt::format("{}: {} (seed {}). {}", method, words_of(*failures), run->use.seed,
                               kFailureAdvice));
    return;
  }
}

bool any_has(const ReportData& data, Check check) {
  return std::ranges::any_of(data.methods,
                             [&](const auto& method) { return data.checks_of(method).has(check); });
}

std::string calibration_text(const ReportData& data) {
  const bool calibrates = std::ranges::any_of(
      data.methods, [&](const auto& method) { return data.checks_of(method).calibrates(); });
  if (!calibrates) return "";
  return fmt::format(
      " Those of round 1 concern the network that has learnt from the whole prior, over {} fresh "
      "simulations of it; the others the last round.",
      data.plan.study.diagnose.num_simulations);
}

// Checks that the study asks for and that mean nothing to a method.
void note_left_out(const ReportData& data, const std::string& method, Table& table) {
  const Study& study = data.plan.study;
  const DiagnoseConfig applied = data.checks_of(method);
  std::vector<std::string> left_out;
  for (const Check check : study.diagnose.checks) {
    if (!applied.has(check)) left_out.push_back(name_of(check));
  }
  if (left_out.empty()) return;
  table.footnote(fmt::format("{}: without {}: {}", method, join(left_out),
                             study.source().simulates
                                 ? "there is no network that could be asked about other "
                                   "observations"
                                 : "a dataset can't be asked for other simulations"));
}

Table make(const ReportData& data) {
  const DiagnoseConfig& config = data.plan.study.diagnose;
  Table table = empty_table(
      fmt::format(
          "Checks of the posteriors. A method without fault fails any of its checks, in any of its "
          "seeds, with a probability of at most {}: p is compared with that over the number of the "
          "method's checks and seeds. p: the smallest of the seeds.{}",
          config.alpha, calibration_text(data)),
      "Check", data.methods);
  for (const CheckTraits& check : enum_table(Check{})) {
    if (!any_has(data, check.value)) continue;
    add_row(table, std::string(check.title), data.methods,
            [&](const std::string& method) { return check_cell(data, method, check.value); });
  }
  for (const std::string& method : data.methods) {
    note_left_out(data, method, table);
    const Runs runs = data.diagnoses_of(method);
    note_outside(method, runs, level_of(data, method, runs), table);
    note_unpredicted(method, runs, level_of(data, method, runs), table);
    note_failures(method, runs, level_of(data, method, runs), table);
  }
  return table;
}

bool exists(const ReportData& data) {
  return has_posteriors(data) && !data.plan.study.diagnose.checks.empty();
}

}  // namespace

/// One row a check, one column a method. A check fails below alpha over the number of checks and
/// seeds of the method.
TableEntry diagnostics_table() { return {"diagnostics", Section::diagnostics, exists, make}; }

}  // namespace npdr::pipeline
