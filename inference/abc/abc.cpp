#include "inference/abc/abc.h"

#include "core/error.h"
#include "inference/abc/abc_mcmc.h"
#include "inference/abc/abc_smc.h"
#include "inference/abc/acceptance.h"
#include "inference/algorithms/algorithm_config.h"

namespace npdr::inference {
namespace {

AbcPopulation first_population(const AbcConfig& config, const Prior& prior, const AbcRound& round) {
  const Accepted accepted = accept_first(round.distances, config);
  require_enough(accepted, round.distances.size(), prior.dimension());
  const auto n = static_cast<Index>(accepted.rows.size());
  return {.theta = round.theta(accepted.rows, Eigen::all),
          .weights = Vector::Constant(n, 1.0 / static_cast<double>(n)),
          .distances = round.distances(accepted.rows),
          .epsilon = accepted.epsilon,
          .kernel = {}};
}

}  // namespace

AbcPopulation advance(const std::string& algorithm, const AbcConfig& config, const Prior& prior,
                      const AbcRound& round, const std::optional<AbcPopulation>& previous,
                      const StreamId& id) {
  const std::string name = canonical_algorithm(algorithm);
  if (name == "abc_mcmc") {
    return previous ? advance_chains(prior, round, *previous, id)
                    : start_chains(prior, first_population(config, prior, round),
                                   round.theta.rows(), id);
  }
  AbcPopulation population = previous && name == "abc_smc"
                                 ? next_population(config, prior, round, *previous)
                                 : first_population(config, prior, round);
  if (name == "abc_smc") population.kernel = twice_the_covariance(prior, population);
  return population;
}

RowMatrix propose(const std::string& algorithm, const Prior& prior, const AbcPopulation& population,
                  Index n, const StreamId& id) {
  const std::string name = canonical_algorithm(algorithm);
  if (name == "abc_mcmc") return propose_steps(prior, population, n, id);
  if (name == "abc_smc") return propose_moved(prior, population, n, id);
  throw InputError("algorithm '" + name + "' has one round, there is nothing to propose from");
}

}  // namespace npdr::inference
