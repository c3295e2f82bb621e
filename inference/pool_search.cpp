#include "inference/pool_search.h"

#include <cmath>

#include "core/log_sum_exp.h"
#include "inference/standard_normal.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
namespace {

constexpr Index kSearchers = 30;     // by hand: a block of rows that networks evaluate together
constexpr double kLeastMissed = 0.05;  // of pi; less is an error among others (importance sampling's)
const double kLogQuarter = std::log(0.25);

// log pi / q but for log Z.
Vector log_ratio(const PoolDensities& at) { return numbers(at.likelihood - at.posterior); }

}  // namespace

PoolSearch search_beyond(const RowMatrix& u,
                         const std::function<PoolDensities(const RowMatrix& u)>& densities,
                         const StreamId& id) {
  const Index n = u.rows(), dimension = u.cols();
  RowMatrix starts(2 * n, dimension);
  starts << u, draw_standard_normal(n, dimension, within(id, "pool_search_starts"));
  const PoolDensities at_starts = densities(starts);
  const Vector ratio = log_ratio(at_starts);
  WeightSearch search = begin_search(starts, at_starts.likelihood, ratio, kSearchers);
  StreamId steps = within(id, "pool_search_steps");
  for (; search.num_steps < num_search_steps(dimension); ++steps.epoch) {
    const RowMatrix proposed = propose_search_steps(search, steps);
    const PoolDensities there = densities(proposed);
    take_search_steps(search, proposed, there.likelihood, log_ratio(there),
                      within(steps, "pool_search_choice"));
  }
  std::vector<FlowProposal> places = found_places(search, 1.0, log_mean_exp(ratio.head(n)));
  if (places.empty()) return {};
  PoolSearch found{.places = {std::move(places), 0.0}};
  RowMatrix all(2 * n, dimension);
  all << u, found.places.sample(n, dimension, within(id, "pool_search_draws"));
  const PoolDensities at = densities(all);
  const Vector log_prior = log_standard_normal<double>(all);
  const Vector log_q = log_prior + numbers(at.posterior), log_pi = log_prior + numbers(at.likelihood);
  const Vector log_mixture =
      log_sum_exp_of_terms(std::vector<Vector>{log_q, found.places.log_density(all)}).array() -
      std::log(2.0);
  const WeightedPopulation drawn(all, log_pi - log_mixture);
  found.log_evidence = drawn.log_mean_weight();
  const Vector weights = drawn.weights();
  const auto is_missed = (log_q - log_pi).array() < kLogQuarter - found.log_evidence;
  found.missed = is_missed.select(weights.array(), 0.0).sum() / weights.sum();
  return found.missed < kLeastMissed ? PoolSearch{} : found;
}

}  // namespace npdr::inference
