#include "inference/abc/abc.h"

#include "core/error.h"
#include "inference/abc/abc_mcmc.h"
#include "inference/abc/abc_smc.h"
#include "inference/abc/acceptance.h"

namespace npdr::inference {
namespace {

AbcPopulation first_population(const AbcConfig& config, const Prior& prior, const AbcRound& round) {
  const Accepted accepted = accept_first(round.distances, config);
  require_enough(accepted, round.distances, prior.dimension());
  const auto n = static_cast<Index>(accepted.rows.size());
  return {.theta = round.theta(accepted.rows, Eigen::all),
          .weights = Vector::Constant(n, 1.0 / static_cast<double>(n)),
          .distances = round.distances(accepted.rows),
          .epsilon = accepted.epsilon,
          .kernel = {}};
}

}  // namespace

AbcPopulation advance(Algorithm algorithm, const AbcConfig& config, const Prior& prior,
                      const AbcRound& round, const std::optional<AbcPopulation>& previous,
                      const StreamId& id) {
  if (algorithm == Algorithm::abc_mcmc) {
    return previous ? advance_chains(prior, round, *previous, id)
                    : start_chains(prior, first_population(config, prior, round),
                                   round.theta.rows(), id);
  }
  const bool is_smc = algorithm == Algorithm::abc_smc;
  AbcPopulation population = previous && is_smc ? next_population(config, prior, round, *previous)
                                                : first_population(config, prior, round);
  if (is_smc) population.kernel = twice_the_covariance(prior, population);
  return population;
}

RowMatrix propose(Algorithm algorithm, const Prior& prior, const AbcPopulation& population, Index n,
                  const StreamId& id) {
  if (algorithm == Algorithm::abc_mcmc) return propose_chain_steps(prior, population, n, id);
  if (algorithm == Algorithm::abc_smc) return propose_moved(prior, population, n, id);
  throw InputError("algorithm '" + name_of(algorithm) +
                   "' has one round, there is nothing to propose from");
}

}  // namespace npdr::inference
