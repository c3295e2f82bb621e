#include "pipeline/artefacts/baseline_file.h"

#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/theta_columns.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

void write_baseline(h5::File& file, const std::vector<inference::Marginal>& prior,
                    const std::vector<BaselinePoint>& points) {
  const auto n = static_cast<Index>(points.size());
  std::vector<std::string> names;
  RowMatrix theta(n, static_cast<Index>(prior.size()));
  std::map<std::string, Vector> metrics;
  for (Index i = 0; i < n; ++i) {
    const BaselinePoint& point = points[static_cast<std::size_t>(i)];
    names.push_back(point.name);
    theta.row(i) = point.theta.transpose();
    for (const auto& [metric, value] : point.metrics) {
      metrics.try_emplace(metric, Vector(n)).first->second(i) = value;
    }
  }
  file.write_texts("name", names);
  write_theta(file, prior, theta);
  for (const auto& [metric, values] : metrics) {
    file.write(metric, values).label_dimensions({"row"});
  }
}

std::vector<BaselinePoint> read_baseline(const ArtefactFile& baseline) {
  const h5::File file = open_artefact(baseline, kBaselineSchema);
  const std::vector<std::string> names = file.read_texts("name");
  const auto n = static_cast<Index>(names.size());
  const RowMatrix theta = file.read_matrix<double>("theta", n);
  std::vector<BaselinePoint> points;
  for (Index i = 0; i < n; ++i) {
    points.push_back({names[static_cast<std::size_t>(i)], theta.row(i).transpose(), {}});
  }
  for (const std::string& metric : all_measured_names()) {
    if (!file.has(metric)) continue;
    const Vector values = file.read_vector<double>(metric, n);
    for (Index i = 0; i < n; ++i) points[static_cast<std::size_t>(i)].metrics[metric] = values(i);
  }
  return points;
}

}  // namespace npdr::pipeline
