#include "inference/abc/abc_mcmc.h"

#include <cmath>
#include <string>

#include "core/error.h"
#include "inference/abc/step_kernel.h"
#include "inference/samplers/step_length.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
namespace {

StreamId of_chain(StreamId id, std::string_view name, Index chain) {
  id.row += static_cast<std::uint64_t>(chain);
  return named(id, name);
}

void require_chains(const AbcPopulation& population, Index n) {
  if (population.num_chains == n && population.theta.rows() >= n) return;
  throw InputError("ABC: " + std::to_string(population.num_chains) +
                   " chains, must be num_simulations = " + std::to_string(n) +
                   ", one simulation a chain and round");
}

// Each chain's own weight, whatever its draws.
Vector equal_weights(Index n) { return Vector::Constant(n, 1.0 / static_cast<double>(n)); }

}  // namespace

AbcPopulation start_chains(const Prior& prior, const AbcPopulation& first, Index num_chains,
                           const StreamId& id) {
  const Resampler resampler(first.weights);
  std::vector<Index> starts;
  for (Index c = 0; c < num_chains; ++c) {
    starts.push_back(resampler.draw(Stream(of_chain(id, "abc_start", c)).uniform()));
  }
  const Eigen::MatrixXd covariance =
      weighted_covariance(prior.to_normal(first.theta), first.weights);
  return {.theta = first.theta(starts, Eigen::all),
          .weights = equal_weights(num_chains),
          .distances = first.distances(starts),
          .epsilon = first.epsilon,
          .kernel = kBestStep * kBestStep / static_cast<double>(prior.dimension()) * covariance,
          .num_chains = num_chains};
}

RowMatrix propose_chain_steps(const Prior& prior, const AbcPopulation& population, Index n,
                              const StreamId& id) {
  require_chains(population, n);
  const StepKernel kernel(population.kernel, prior.dimension());
  RowMatrix u = prior.to_normal(population.theta.bottomRows(n));
  for (Index c = 0; c < n; ++c) {
    Stream stream(of_chain(id, id.name, c));
    u.row(c) += kernel.sample(stream).transpose();
  }
  return prior.to_theta(u);
}

AbcPopulation advance_chains(const Prior& prior, const AbcRound& round,
                             const AbcPopulation& previous, const StreamId& id) {
  const Index chains = round.theta.rows();
  require_chains(previous, chains);
  RowMatrix theta = previous.theta.bottomRows(chains);
  Vector distances = previous.distances.tail(chains);
  const Vector norms = prior.to_normal(theta).rowwise().squaredNorm();
  const Vector proposed = prior.to_normal(round.theta).rowwise().squaredNorm();
  for (Index c = 0; c < chains; ++c) {
    const double log_ratio = 0.5 * (norms(c) - proposed(c));  // log p(u') / p(u)
    const double uniform = Stream(of_chain(id, "abc_accept", c)).uniform();
    if (!(round.distances(c) <= previous.epsilon) || std::log(uniform) >= log_ratio) continue;
    theta.row(c) = round.theta.row(c);
    distances(c) = round.distances(c);
  }
  // The draws of rounds floor((r - 1) / 2) + 1 to r - 1 are there.
  const bool drops_one = id.round % 2 == 0;
  const Index kept = previous.theta.rows() - (drops_one ? chains : 0);
  AbcPopulation next = previous;
  next.theta.resize(kept + chains, theta.cols());
  next.theta << previous.theta.bottomRows(kept), theta;
  next.distances.resize(kept + chains);
  next.distances << previous.distances.tail(kept), distances;
  next.weights = equal_weights(kept + chains);
  return next;
}

}  // namespace npdr::inference
