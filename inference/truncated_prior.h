/// The prior within the region where a posterior has all but nothing of its mass:
///   p~(u) ~ p(u) 1[ p(u | x_o) / p(u) >= tau ],
/// with tau the ratio that 1e-4 of the posterior's mass has less than, told by weighted draws of
/// its importance_proposal(): of all regions with as much of that mass the one with the least of
/// the prior's, whatever the parameters' scales (Deistler, Goncalves and Macke 2022, "Truncated
/// proposals for scalable and hassle-free simulation-based inference", TSNPE, whose priors are
/// uniform). Networks that learn of its draws by maximum likelihood need no correction: within the
/// region it is the prior.
///
/// It is sampled by importance: candidates are a third each draws of the prior, of the posterior's
/// importance_proposal(), and of a Gaussian twice as wide as that posterior, which are weighted by
/// p~ over their mixture (Veach and Guibas 1995, the balance heuristic) and resampled. Where they
/// aren't worth enough, what is resampled takes Metropolis steps (group_moves.h), which leave p~ as
/// it is.
#pragma once

#include <cstdint>
#include <vector>

#include "inference/estimators/gaussian_mixture.h"
#include "inference/network_posterior.h"

namespace npdr::inference {

/// Const calls are thread-safe.
class TruncatedPrior {
 public:
  /// Keeps a reference.
  explicit TruncatedPrior(const NetworkPosterior& posterior);

  /// The rows of theta (n, D) that lie in the region, ascending.
  std::vector<std::uint32_t> rows_within(const RowMatrix& theta) const;
  /// The share of the prior's mass that lies in the region. Throws Error as sample().
  double prior_mass() const;
  /// (n, D) draws, inside of the region. Row i depends on `id` and i alone, not on n. Throws Error
  /// when no candidate lies there.
  RowMatrix sample(Index n, const StreamId& id) const;

 private:
  struct Candidates;

  Vector log_ratio(const RowMatrix& theta) const;
  Vector inside(const RowMatrix& theta, const Vector& values) const;
  Candidates draw_candidates(StreamId id) const;
  void move(RowMatrix& u, Stream& stream) const;
  RowMatrix draw_group(const StreamId& id) const;

  const NetworkPosterior& posterior_;
  const Posterior& near_;
  double threshold_;        // log tau [nats] but for a constant
  GaussianMixture around_;  // over u, twice as wide as the posterior
};

}  // namespace npdr::inference
