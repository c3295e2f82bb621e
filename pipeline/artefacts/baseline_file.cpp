#include "pipeline/artefacts/baseline_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/artefacts/described_artefact.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {
namespace {

// The points' columns, and scores by point.
struct Columns {
  std::vector<std::string> names;
  RowMatrix theta;
  std::map<std::string, Vector> metrics;
  std::vector<RolloutScores> scores;
};

std::vector<std::string> metrics_of(const Layout& f) { return f.those_there(all_measured_names()); }

void describe(Layout f, PriorPredictions& prior) {
  f.each(prior.metrics, metrics_of(f), {{"S", "row"}},
         "metrics of S draws of the prior; NaN where the rollouts failed");
  describe(f, prior.scores);
}

void describe(Layout f, Columns& c, const std::vector<inference::Marginal>& prior,
              std::optional<PriorPredictions>& predictions) {
  f("name", c.names, {{"n"}},
    "`nominal`; the study's references; then `truth` for a simulated target, or `floor` for a "
    "recording with `evaluate.floor`");
  f("theta", c.theta, {kRow, kParameter}, "their parameters").columns(prior);
  f.each(c.metrics, metrics_of(f), {kRow},
         "their metrics, named as in an [evaluation](#evaluation); NaN where the rollouts failed");
  c.scores.resize(std::max<std::size_t>(1, c.names.size()));
  for (std::size_t i = 0; i < c.scores.size(); ++i) {
    describe(f.group(fmt::format("point_{}", i + 1)), c.scores[i]);
  }
  if (auto group = f.group("prior", predictions)) describe(*group, *predictions);
}

}  // namespace

void describe(Layout f, Baseline& baseline) {
  const auto n = static_cast<Index>(baseline.points.size());
  Columns columns{{}, RowMatrix(n, std::ssize(baseline.parameters)), {}, {}};
  for (Index i = 0; i < n; ++i) {
    const BaselinePoint& point = baseline.points[static_cast<std::size_t>(i)];
    columns.names.push_back(point.name);
    columns.theta.row(i) = point.theta.transpose();
    for (const auto& [metric, value] : point.metrics) {
      columns.metrics.try_emplace(metric, Vector(n)).first->second(i) = value;
    }
    columns.scores.push_back(point.scores);
  }
  describe(f, columns, baseline.parameters, baseline.prior);
  if (!f.reads()) return;
  for (Index i = 0; i < columns.theta.rows(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    baseline.points.push_back(
        {columns.names[at], columns.theta.row(i).transpose(), {}, columns.scores[at]});
    for (const auto& [metric, values] : columns.metrics) {
      baseline.points.back().metrics[metric] = values(i);
    }
  }
}
template struct Artefact<Baseline>;

}  // namespace npdr::pipeline
