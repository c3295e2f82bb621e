#include <algorithm>

#include "analysis/floor.h"
#include "pipeline/artefacts/baseline_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/predictions/judge.h"
#include "pipeline/predictions/search_box.h"
#include "pipeline/process/progress.h"
#include "pipeline/process/stop_request.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

// `number`: that of the point, which names the random numbers of a simulator that draws some.
BaselinePoint measure(const Plan& plan, const Judge& judge, const std::string& name,
                      const Vector& complete, std::size_t number) {
  return {name, plan.source->parameters().pick_one(complete),
          judge.measure_one(complete, {0, "external_baseline", 0, number, 0})};
}

// A search that costs as much as the simulations of one experiment, where the plan has a budget.
analysis::FloorConfig floor_config(Index num_evaluations) {
  analysis::FloorConfig config;
  if (num_evaluations == 0) return config;
  constexpr Index local_parts = 5;  // one for each of the two local searches
  config.num_restarts = 1;
  config.population = 64;
  config.max_local_evaluations = std::max<Index>(1, num_evaluations / local_parts);
  const Index global = num_evaluations - 2 * config.max_local_evaluations;
  config.max_generations = std::max<Index>(1, global / config.population);
  return config;
}

// Nominal values inside of the box; the middle of it where there are none.
Vector search_start(const ParameterMap& parameters, const SearchBox& box) {
  const Vector nominal = parameters.pick_one(parameters.nominal());
  const Vector middle = 0.5 * (box.lower + box.upper);
  return nominal.array().isFinite().select(nominal, middle).cwiseMax(box.lower).cwiseMin(box.upper);
}

BaselinePoint find_floor(const Plan& plan, const Node& node, const Judge& judge) {
  const ParameterMap& parameters = plan.source->parameters();
  const SearchBox box = search_box(plan.study.prior, plan.source->info());
  const Vector start = search_start(parameters, box);
  Progress progress(node.label() + ", floor evaluations", 0);
  Index num_evaluations = 0;
  const auto objective = [&](const RowMatrix& theta) {
    stop_here_if_requested();
    num_evaluations += theta.rows();
    progress.update(num_evaluations);
    return judge.seen().rmse(theta);
  };
  const analysis::FloorResult floor =
      analysis::find_floor(objective, box.lower, box.upper, start.transpose(),
                           floor_config(plan.num_floor_evaluations()));
  return measure(plan, judge, "floor", parameters.complete(floor.theta.transpose()).transpose(), 0);
}

}  // namespace

void run_baseline(const Plan& plan, const Node& node) {
  ArtefactWriter writer(node.path, kBaselineSchema, node.identity);
  const Judge judge(plan, node);
  std::vector<BaselinePoint> points;
  const auto add = [&](const std::string& name, const std::map<std::string, double>& values) {
    const Vector complete = plan.source->parameters().nominal(values);
    points.push_back(measure(plan, judge, name, complete, points.size()));
  };
  if (plan.source->has_nominal()) add("nominal", {});
  for (const ReferenceConfig& reference : plan.study.references) {
    add(reference.name, reference.parameters);
  }
  if (const auto& truth = plan.study.target.truth) {
    add("truth", *truth);
  } else if (plan.study.evaluate.floor) {
    points.push_back(find_floor(plan, node, judge));
  }
  write_baseline(writer.file(), plan.study.prior, points);
  writer.finish();
}

}  // namespace npdr::pipeline
