/// The posteriors of two networks, q(u | z_o) of NPE and l(z_o | u) N(u; 0, I) of NLE, pooled:
///   p(u | x_o) = 1/Z q(u | z_o)^(1 - a) (l(z_o | u) N(u; 0, I))^a,
/// the logarithmic opinion pool (Genest and Zidek 1986, "Combining probability distributions"),
/// whose weight a in [0, 1] predicted held-out parameters best (algorithms/pool_weight.h). Errors
/// that the two don't share cancel in part; where one of them is useless, a leaves it out.
///
/// It is sampled by importance: draws of q, resampled with weights
///   w(u) = (l(z_o | u) N(u; 0, I) / q(u | z_o))^a
/// (Dax et al. 2023, "Neural importance sampling for rapid and reliable gravitational-wave
/// inference"; Gloeckler et al. 2022, "Variational methods for simulation-based inference"), so
/// that no chain has to find its way between modes. Z is the mean of w over draws of q. Where the
/// two contradict each other at x_o, as when it is like no simulation, a is lowered until
/// kSmallestEfficiency of q's draws remain.
#pragma once

#include "inference/direct_posterior.h"
#include "inference/surrogate_posterior.h"

namespace npdr::inference {

class PooledPosterior : public NetworkPosterior {
 public:
  /// Least effective size of the weights, as a share of the draws of q.
  static constexpr double kSmallestEfficiency = 0.05;

  /// Throws ShapeError when the parts don't go together.
  explicit PooledPosterior(NetworkParts parts);
  ~PooledPosterior() override;

  Samples draw(Index n, const StreamId& id) const override;
  Vector log_prob(const RowMatrix& theta) const override;
  Vector relative_log_prob(const RowMatrix& theta) const override;

  /// The weight a, and log Z [nats], at x_o.
  double weight() const;
  double log_normalizer() const;

 private:
  struct Known;

  Vector log_ratio(const RowMatrix& theta, const Vector& log_q) const;
  Vector log_ratio_of_draws(Index n, const StreamId& id) const;
  RowMatrix draw_group(const StreamId& id, double& effective_size, Index& num_candidates) const;
  double largest_usable_weight() const;
  double estimate_log_normalizer() const;

  DirectPosterior posterior_;
  SurrogatePosterior likelihood_;
  std::unique_ptr<Known> known_;
};

/// The parts of NPE's networks alone.
NetworkParts posterior_parts(NetworkParts parts);
/// The parts of NLE's networks, without weights where `parts` has none: the features that vary, the
/// same estimator and seed.
NetworkParts likelihood_parts(NetworkParts parts);

}  // namespace npdr::inference
