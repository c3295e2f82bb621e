#include "inference/missed_share.h"

#include <cmath>
#include <vector>

#include "core/log_sum_exp.h"
#include "inference/samplers/importance_constants.h"
#include "inference/samplers/importance_state.h"
#include "inference/standard_normal.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
namespace {

constexpr Index kSearchers = 30;  // by hand: about as many as are evaluated together

// q has nothing where it is less than pi by so much [nats], of which more belongs to more
// dimensions: where q is half as wide as a Gaussian pi it has nothing of 3 % of that.
constexpr double kNothing = 4.0, kNothingOfDimension = 2.0;

// log of pi over q with the prior's share, whose tails are no heavier than its own: w is largest
// at the modes that q hasn't, not where the prior ends.
Vector log_ratio(const ComparedDensities& at) {
  const std::vector<Vector> terms = {numbers(at.q).array() + std::log1p(-kPriorShare),
                                     Vector::Constant(at.q.size(), std::log(kPriorShare))};
  return numbers(at.pi - log_sum_exp_of_terms(terms));
}

}  // namespace

double missed_share(const RowMatrix& u,
                    const std::function<ComparedDensities(const RowMatrix& u)>& densities,
                    const StreamId& id) {
  const Index n = u.rows(), dimension = u.cols();
  RowMatrix starts(2 * n, dimension);
  starts << u, draw_standard_normal(n, dimension, within(id, "missed_starts"));
  const ComparedDensities at_starts = densities(starts);
  const Vector ratio = log_ratio(at_starts);
  WeightSearch search = begin_search(starts, at_starts.pi, ratio, kSearchers);
  StreamId step = within(id, "missed_steps");
  for (; search.num_steps < num_search_steps(dimension); ++step.epoch) {
    const RowMatrix proposed = propose_search_steps(search, step);
    const ComparedDensities there = densities(proposed);
    take_search_steps(search, proposed, there.pi, log_ratio(there), within(step, "missed_choice"));
  }
  const ImportanceProposal places{
      found_places(search, 1.0, log_mean_exp(numbers(at_starts.pi - at_starts.q).head(n))), 0.0};
  if (places.flows.empty()) return 0.0;

  RowMatrix drawn(2 * n, dimension);
  drawn << u, places.sample(n, dimension, within(id, "missed_draws"));
  const ComparedDensities at = densities(drawn);
  const Vector log_prior = log_standard_normal<double>(drawn);
  const Vector log_q = log_prior + numbers(at.q), log_pi = log_prior + numbers(at.pi);
  const std::vector<Vector> mixed = {log_q, places.log_density(drawn)};
  const WeightedPopulation of_pi(drawn,
                                 (log_pi - log_sum_exp_of_terms(mixed)).array() + std::log(2.0));
  if (!of_pi.has_weight()) return 0.0;
  const double least =
      of_pi.log_mean_weight() + kNothing + kNothingOfDimension * static_cast<double>(dimension);
  const auto is_missed = (log_pi - log_q).array() > least;
  const Vector weights = of_pi.weights();
  return is_missed.select(weights.array(), 0.0).sum() / weights.sum();
}

}  // namespace npdr::inference
