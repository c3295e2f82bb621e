#include "pipeline/artefacts/baseline_file.h"

#include "pipeline/artefacts/layout_tables.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {
namespace {

// The points' columns.
struct Columns {
  std::vector<std::string> names;
  RowMatrix theta;
  std::map<std::string, Vector> metrics;
};

void describe(Layout f, Columns& c, const std::vector<inference::Marginal>& prior) {
  f("name", c.names, {{"n"}},
    "`nominal`; the study's references; then `truth` for a simulated target, or `floor` for a "
    "recording with `evaluate.floor`");
  f("theta", c.theta, {kRow, kParameter}, "their parameters").columns(prior);
  f.each(c.metrics, f.those_there(all_measured_names()), {kRow},
         "their metrics, named as in an [evaluation](#evaluation); NaN where the rollouts failed");
}

}  // namespace

void write_baseline(h5::File& file, const std::vector<inference::Marginal>& prior,
                    const std::vector<BaselinePoint>& points) {
  const auto n = static_cast<Index>(points.size());
  Columns columns{{}, RowMatrix(n, static_cast<Index>(prior.size())), {}};
  for (Index i = 0; i < n; ++i) {
    const BaselinePoint& point = points[static_cast<std::size_t>(i)];
    columns.names.push_back(point.name);
    columns.theta.row(i) = point.theta.transpose();
    for (const auto& [metric, value] : point.metrics) {
      columns.metrics.try_emplace(metric, Vector(n)).first->second(i) = value;
    }
  }
  describe(Layout::writer(file), columns, prior);
}

std::vector<BaselinePoint> read_baseline(const ArtefactFile& baseline) {
  const h5::File file = open_artefact(baseline, kBaselineSchema);
  Columns columns;
  describe(Layout::reader(file), columns, {});
  std::vector<BaselinePoint> points;
  for (Index i = 0; i < columns.theta.rows(); ++i) {
    points.push_back(
        {columns.names[static_cast<std::size_t>(i)], columns.theta.row(i).transpose(), {}});
    for (const auto& [metric, values] : columns.metrics) points.back().metrics[metric] = values(i);
  }
  return points;
}

void list_baseline(Layout f) {
  Columns columns;
  describe(f, columns, {});
}

}  // namespace npdr::pipeline
