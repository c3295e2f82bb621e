#include "pipeline/report/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "analysis/interval_plot.h"
#include "analysis/pair_plot.h"
#include "core/quantile.h"
#include "core/text.h"
#include "pipeline/predictions/policy_rollouts.h"

namespace npdr::pipeline {

namespace {

Metric metric_of(const std::string& measured) {
  const bool is_held_out = measured.starts_with(kHeldOutPrefix);
  return parse_enum<Metric>("metric", measured.substr(is_held_out ? kHeldOutPrefix.size() : 0));
}

}  // namespace

std::string title_of(const ReportData& data, const std::string& metric) {
  const std::string where = metric.starts_with(kHeldOutPrefix) ? ", held out" : "";
  return title_of(metric_of(metric), data.info) + where;
}

double ideal_of(const std::string& metric) { return metric_of(metric) == Metric::goal ? 1.0 : 0.0; }

Cell cell_of(const analysis::Summary& summary) { return with_failed(summary, summary); }

Cell with_failed(Cell cell, const analysis::Summary& summary) {
  if (summary.n_failed > 0) {
    cell.notes.push_back(fmt::format("{} of {} samples left out: their simulations failed",
                                     summary.n_failed, summary.n + summary.n_failed));
  }
  return cell;
}

Cell cell_of_seeds(const analysis::Summary& summary) {
  Cell cell(summary);
  if (summary.n_failed > 0) {
    cell.notes.push_back(
        fmt::format("of {} of {} seeds: of the others every rollout failed, in one part at least",
                    summary.n, summary.n + summary.n_failed));
  }
  return cell;
}

std::string noiseless_bands_text(const Study& study) {
  if (!study.target.recording || study.observation_noise.is_silent()) return "";
  return " The recording has noise, so bands without noise contain less than their level.";
}

std::vector<KnownPoint> known_points(const ReportData& data) {
  const Study& study = data.plan.study;
  std::vector<KnownPoint> points;
  if (data.plan.source->has_nominal()) {
    points.push_back({"nominal", {}, [](const Evaluation& e) { return *e.nominal_log_prob; }});
  }
  if (study.target.truth) {
    points.push_back(
        {"truth", *study.target.truth, [](const Evaluation& e) { return *e.truth_log_prob; }});
  }
  for (const auto& [name, parameters] : study.references) {
    points.push_back({name, parameters, [&name = name](const Evaluation& e) {
                        return e.reference_log_prob.at(name);
                      }});
  }
  return points;
}

std::vector<std::string> density_notes(const ReportData& data) {
  const auto& prior = data.plan.study.prior;
  std::vector<std::string> notes;
  for (const ReferenceConfig& reference : data.plan.study.references) {
    std::vector<std::string> fixed;
    for (const auto& [name, value] : reference.parameters) {
      if (std::ranges::find(prior, name, &inference::Marginal::name) == prior.end()) {
        fixed.push_back(name);
      }
    }
    if (fixed.empty()) continue;
    notes.push_back(fmt::format(
        "log p({}) is the density of its parameters in the prior alone; the posterior has others "
        "of {}",
        reference.name, join(fixed)));
  }
  for (const std::string& method : data.methods) {
    std::vector<std::string> known;
    for (std::size_t d = 0; d < prior.size(); ++d) {
      if (!data.is_inferred(method, static_cast<Index>(d))) known.push_back(prior[d].name);
    }
    if (known.empty()) continue;
    notes.push_back(fmt::format("{} takes as known: {}; its log p is the density of the others",
                                method, join(known)));
  }
  return notes;
}

std::string interval_text(double low, double high) {
  return fmt::format("[{:.4g}, {:.4g}]", low, high);
}

std::string interval_text(const Vector& samples) {
  return interval_text(quantile(samples, 0.05), quantile(samples, 0.95));
}

std::vector<std::string> drawn_methods(std::vector<std::string> methods) {
  methods.resize(std::min(methods.size(), analysis::kMaxMethods));
  return methods;
}

std::string left_out_methods(const std::vector<std::string>& methods) {
  const std::size_t drawn = drawn_methods(methods).size();
  if (drawn == methods.size()) return "";
  return fmt::format(" The first {} of {} methods.", drawn, methods.size());
}

std::vector<Index> shown_parameters(const Study& study) {
  std::vector<Index> shown;
  if (study.report.parameters.empty()) {
    shown.resize(std::min<std::size_t>(study.prior.size(), analysis::kMaxPairParameters));
    std::iota(shown.begin(), shown.end(), Index{0});
  }
  for (const std::string& name : study.report.parameters) {
    const auto found = std::ranges::find(study.prior, name, &inference::Marginal::name);
    shown.push_back(found - study.prior.begin());
  }
  return shown;
}

std::string left_out_parameters(const Study& study) {
  const std::size_t shown = shown_parameters(study).size();
  if (shown == study.prior.size()) return "";
  return fmt::format(" {} of {} parameters.", shown, study.prior.size());
}

RowMatrix interval_quantiles(const RowMatrix& samples) {
  RowMatrix quantiles(samples.cols(), std::ssize(analysis::kIntervalLevels));
  for (Index d = 0; d < samples.cols(); ++d) {
    const std::vector<double> sorted = sorted_finite(samples.col(d));
    Index k = 0;
    for (const double level : analysis::kIntervalLevels) {
      quantiles(d, k++) = quantile_of_sorted(sorted, level);
    }
  }
  return quantiles;
}

std::vector<const PolicyTest*> tests_of(const ReportData& data, const std::string& method,
                                        Searches searches) {
  std::vector<const PolicyTest*> tests;
  for (const auto& run : data.policy_tests) {
    const Searches of_run = run.use.iteration == 0 ? Searches::before : Searches::after;
    if (run.use.method == method && of_run == searches) tests.push_back(&run.result);
  }
  return tests;
}

std::vector<const PolicyHistory*> histories_of(const ReportData& data, const std::string& method,
                                               std::uint64_t seed) {
  std::vector<const PolicyHistory*> histories;
  for (const auto& run : data.policies) {  // iterations of one seed are in their order
    if (run.use.method == method && run.use.seed == seed) histories.push_back(&run.result);
  }
  return histories;
}

sim::PolicyTaskInfo task_info(const ReportData& data) { return make_task(data.plan.study)->info(); }

}  // namespace npdr::pipeline
