#include "analysis/floor.h"
#include "pipeline/plan/schemas.h"
#include "pipeline/run/progress.h"
#include "pipeline/run/stop_request.h"
#include "pipeline/stages/baseline_file.h"
#include "pipeline/stages/judge.h"
#include "pipeline/stages/search_box.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

// `number`: that of the point, which names the random numbers of a simulator that draws some.
BaselinePoint measure(const Judge& judge, const std::string& name, const Vector& complete,
                      std::size_t number) {
  return {name, judge.seen().pick(complete),
          judge.measure_one(complete, {0, "external_baseline", 0, number, 0})};
}

BaselinePoint find_floor(const Plan& plan, const Node& node, const Judge& judge) {
  const Predictor& predictor = judge.seen();
  const SearchBox box = search_box(plan.study.prior, predictor.info());
  const Vector start = predictor.pick(predictor.nominal()).cwiseMax(box.lower).cwiseMin(box.upper);
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
  return measure(judge, "floor", predictor.complete(floor.theta.transpose()).transpose(), 0);
}

}  // namespace

void run_baseline(const Plan& plan, const Node& node) {
  ArtefactWriter writer(node.path, kBaselineSchema, node.identity);
  const Judge judge(plan, node);
  const Predictor& predictor = judge.seen();
  std::vector<BaselinePoint> points;
  const auto add = [&](const std::string& name, const Vector& complete) {
    points.push_back(measure(judge, name, complete, points.size()));
  };
  if (!plan.study.external.is_used()) add("nominal", predictor.nominal());
  for (const ReferenceConfig& reference : plan.study.references) {
    add(reference.name, predictor.nominal_with(reference.parameters));
  }
  if (plan.study.target.truth) {
    add("truth", predictor.truth());
  } else if (plan.study.evaluate.floor) {
    points.push_back(find_floor(plan, node, judge));
  }
  write_baseline(writer.file(), plan, points);
  writer.finish();
}

}  // namespace npdr::pipeline
