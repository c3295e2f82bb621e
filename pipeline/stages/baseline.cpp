#include "analysis/floor.h"
#include "pipeline/plan/schemas.h"
#include "pipeline/run/progress.h"
#include "pipeline/run/stop_request.h"
#include "pipeline/stages/baseline_file.h"
#include "pipeline/stages/prediction.h"
#include "pipeline/stages/search_box.h"
#include "pipeline/stages/stage_files.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

BaselinePoint measure(const Predictor& predictor, const std::string& name, const Vector& theta) {
  BaselinePoint point{name, theta, {}};
  for (const auto& [metric, values] : predictor.measure(predictor.simulate(theta.transpose()))) {
    point.metrics[metric] = values(0);
  }
  return point;
}

BaselinePoint find_floor(const Plan& plan, const Node& node, const Predictor& predictor) {
  const SearchBox box = search_box(plan.study.prior, predictor.simulator().info());
  const Vector start = predictor.nominal().cwiseMax(box.lower).cwiseMin(box.upper);
  Progress progress(node.label() + ", floor evaluations", 0);
  Index num_evaluations = 0;
  const auto objective = [&](const RowMatrix& theta) {
    stop_here_if_requested();
    num_evaluations += theta.rows();
    progress.update(num_evaluations);
    return predictor.rmse(theta);
  };
  const analysis::FloorResult floor =
      analysis::find_floor(objective, box.lower, box.upper, start.transpose());
  return measure(predictor, "floor", floor.theta);
}

}  // namespace

void run_baseline(const Plan& plan, const Node& node) {
  ArtefactWriter writer(node.path, kBaselineSchema, node.identity);
  const Predictor predictor(plan, read_target(plan, node));
  std::vector<BaselinePoint> points = {measure(predictor, "nominal", predictor.nominal())};
  if (plan.study.target.truth) {
    points.push_back(measure(predictor, "truth", predictor.truth()));
  } else if (plan.study.evaluate.floor) {
    points.push_back(find_floor(plan, node, predictor));
  }
  write_baseline(writer.file(), plan, points);
  writer.finish();
}

}  // namespace npdr::pipeline
