// Results of ImportanceSampler.
#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/error.h"
#include "inference/pareto_tail.h"
#include "inference/samplers/importance_constants.h"
#include "inference/samplers/importance_sampler.h"
#include "inference/weighted_population.h"

namespace npdr::inference {

ImportanceSample ImportanceSampler::preliminary(double power, Index most) const {
  if (state_.walkers || state_.search) {
    throw Error("importance sampling: no draws while walkers climb or a search goes on");
  }
  const bool is_planned = !state_.levels.back().is_complete();
  return draws_of_all(std::min(state_.num_before_reported(), state_.levels.size() - is_planned),
                      power, most);
}

ImportanceSample ImportanceSampler::draws_of_all(std::size_t num_levels, double power,
                                                 Index most) const {
  const Vector weights =
      truncated(densities_.mixture_draws(state_.levels, num_levels).log_weights(power));
  const Choice choice = choose_rows(weights, most, level_id("refine_thinning"));
  return {points_of(state_.levels, config_.level_size, choice.rows),
          choice.weights,
          {.ess_of_all = effective_size(weights)}};
}

Vector ImportanceSampler::best_point() const {
  double highest = -kInfinity;
  Vector best;
  for (const ImportanceLevel& level : state_.levels) {
    for (Index i = 0; i < level.log_likelihood.size(); ++i) {
      if (!(level.log_likelihood(i) > highest)) continue;
      highest = level.log_likelihood(i);
      best = level.u.row(i).transpose();
    }
  }
  if (best.size() == 0) throw Error("importance sampler: no point has a likelihood above 0");
  return best;
}

ImportanceSample ImportanceSampler::sample() const {
  const double power = state_.levels.back().power;
  const std::size_t first = state_.num_before_reported();
  const Index each = config_.level_size;
  ImportanceSample sample{RowMatrix(state_.num_levels_of(LevelKind::reported) * each, dimension_),
                          {}};
  Vector logs(sample.u.rows());
  for (std::size_t l = first; l < state_.levels.size(); ++l) {
    const ImportanceLevel& level = state_.levels[l];
    const Index row = static_cast<Index>(l - first) * each;
    sample.u.middleRows(row, each) = level.u;
    logs.segment(row, each) = densities_.log_weights(level);
  }
  sample.weights = exponentials(logs);
  const Evidence all = evidence(logs), even = evidence(logs(Eigen::seq(0, Eigen::last, 2))),
                 odd = evidence(logs(Eigen::seq(1, Eigen::last, 2)));
  if (!(sample.weights.sum() > 0.0)) {
    throw InputError("no simulation of the last levels has a likelihood above 0");
  }
  const double ess = effective_size(sample.weights);
  const double missed =
      state_.heavy_share - heavy_share(sample.weights, logs, state_.heavy_log_weight);
  sample.certificate = {
      .power = power,
      .wanted_power = state_.wanted_power,
      .num_draws = state_.num_draws,
      .ess = ess,
      .wanted_ess = config_.min_ess,
      .efficiency = ess / static_cast<double>(logs.size()),
      .missed_share = missed < 0.0 ? 0.0 : missed,
      .pareto_k = pareto_k(sample.weights),
      .log_evidence = all.log_value,
      .log_evidence_error = all.error,
      .half_difference = (even.log_value - odd.log_value) / std::hypot(even.error, odd.error),
      .searched = state_.num_searches == 0 ? SearchCounts{} : state_.searched};
  return sample;
}

ImportanceSample ImportanceSampler::particles(Index most) const {
  ImportanceSample sample = this->sample();
  if (sample.certificate.ess < kFewOfWanted * config_.min_ess) {
    ImportanceSample known = draws_of_all(state_.num_before_reported(), power(), most);
    const double ess = effective_size(truncated(sample.weights.array().log()));
    if (known.certificate.ess_of_all > ess) {
      sample.certificate.ess_of_all = known.certificate.ess_of_all;
      known.certificate = sample.certificate;
      return known;
    }
  }
  const Choice choice = choose_rows(sample.weights, most, level_id("refine_thinning"));
  sample.u = RowMatrix(sample.u(choice.rows, Eigen::all));
  sample.weights = choice.weights;
  return sample;
}

}  // namespace npdr::inference
