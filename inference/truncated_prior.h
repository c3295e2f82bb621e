/// The prior within the region where a posterior has all but nothing of its mass:
///   p~(u) ~ p(u) 1[ p(u | x_o) / p(u) >= tau ],
/// with tau the ratio that 1e-4 of the posterior's mass has less than: of all regions with as much
/// of that mass the one with the least of the prior's, whatever the parameters' scales (Deistler,
/// Goncalves and Macke 2022, "Truncated proposals for scalable and hassle-free simulation-based
/// inference", TSNPE, whose priors are uniform). Networks that learn of its draws by maximum
/// likelihood need no correction: within the region it is the prior. Draws of several regions do
/// (algorithms/round_task.cpp).
///
/// All of it is told by candidates, a third each draws of the prior, of the posterior's
/// importance_proposal(), and of a Gaussian twice as wide as that posterior, weighted by a density
/// over that of their mixture (Veach and Guibas 1995, the balance heuristic): 15,000, weighted by
/// the posterior, tell tau; others, weighted by p~, are resampled. Where they aren't worth enough,
/// what is resampled takes Metropolis steps (group_moves.h), which leave p~ as it is.
#pragma once

#include <cstdint>
#include <vector>

#include "inference/estimators/gaussian_mixture.h"
#include "inference/network_posterior.h"
#include "inference/weighted_population.h"

namespace npdr::inference {

/// Const calls are thread-safe.
class TruncatedPrior {
 public:
  /// Keeps a reference.
  explicit TruncatedPrior(const NetworkPosterior& posterior);

  /// The rows of theta (n, D) that lie in the region, ascending.
  std::vector<std::uint32_t> rows_within(const RowMatrix& theta) const;
  /// The share of the prior's mass that lies in the region, with a standard error of 3 % of it, or
  /// more where 24,000 candidates aren't worth 1000. Throws Error as sample().
  double prior_mass() const;
  /// (n, D) draws, inside of the region. Row i depends on `id` and i alone, not on n. Throws Error
  /// when no candidate lies there.
  RowMatrix sample(Index n, const StreamId& id) const;

 private:
  Vector log_ratio(const RowMatrix& theta) const;
  Vector inside(const RowMatrix& theta, const Vector& values) const;
  WeightedPopulation draw_mixture(Index n, const StreamId& id) const;
  WeightedPopulation draw_candidates(StreamId id) const;
  void move(RowMatrix& u, Stream& stream) const;
  RowMatrix draw_group(const StreamId& id) const;

  const NetworkPosterior& posterior_;
  const Posterior& near_;
  double threshold_;        // log tau [nats] but for a constant
  GaussianMixture around_;  // over u, twice as wide as the posterior
};

}  // namespace npdr::inference
