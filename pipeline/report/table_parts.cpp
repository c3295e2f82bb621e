#include "pipeline/report/table_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/quantile.h"
#include "core/text.h"

namespace npdr::pipeline {

std::string experiment_label(const std::string& method, std::uint64_t seed) {
  return fmt::format("{}, {}", method, seed);
}

TableOf<Index> table_of_parameters(const ReportData& data, std::string caption) {
  const std::vector<inference::Marginal>& prior = data.plan.study.prior;
  std::vector<Index> positions(prior.size());
  std::iota(positions.begin(), positions.end(), Index{0});
  return {.caption = std::move(caption),
          .row_header = "Parameter",
          .rows = std::move(positions),
          .label = [&](Index d) { return prior[static_cast<std::size_t>(d)].name; }};
}

std::string title_of(const ReportData& data, const std::string& metric) {
  if (metric.starts_with(kHeldOutPrefix)) {
    return title_of(data, metric.substr(kHeldOutPrefix.size())) + ", held out";
  }
  return title_of(parse_enum<Metric>("metric", metric), data.info);
}

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
  return " The recording has noise: without it bands are of what lies below, and hold less.";
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

Vector samples_of(const ReportData& data, const std::string& method, Index d) {
  return pooled(data.runs_of(method),
                [d](const EvaluatedRun* run) -> Vector { return run->evaluation.theta.col(d); });
}

Vector unwrapped_samples_of(const ReportData& data, const std::string& method, Index d) {
  Vector samples = samples_of(data, method, d);
  const double period = data.period_of(d);
  if (!(period > 0.0)) return samples;
  const double mean = data.summary_of(d, samples).mean;
  return samples.unaryExpr([&](double v) { return mean + std::remainder(v - mean, period); });
}

Vector predicted_feature(const ReportData& data, const std::string& method, Index f) {
  return pooled(data.runs_of(method), [f](const EvaluatedRun* run) -> Vector {
    return run->evaluation.x->col(f).cast<double>();
  });
}

}  // namespace npdr::pipeline
