/// The posteriors of two networks, q(u | z_o) of NPE and that of NLE's likelihood l(z_o | u),
/// pooled over the prior p(u) = N(u; 0, I):
///   p_{a,b}(u | x_o) = 1/Z p(u) (q(u | z_o) / p(u))^a l(z_o | u)^b,
/// a logarithmic opinion pool (Genest and Zidek 1986, "Combining probability distributions"), whose
/// powers a, b >= 0 predicted held-out parameters best (algorithms/pool_powers.h). Errors that the
/// two don't share cancel in part; where one of them is useless, its power leaves it out. a + b > 1
/// sharpens posteriors that are too wide, as means of several networks are, a + b < 1 widens; what
/// the data don't tell stays the prior.
///
/// The pool is sampled by importance: draws of q, resampled with weights
///   w(u) = (q(u | z_o) / p(u))^(a - 1) l(z_o | u)^b
/// (Dax et al. 2023, "Neural importance sampling for rapid and reliable gravitational-wave
/// inference"; Gloeckler et al. 2022, "Variational methods for simulation-based inference"), so
/// that no chain has to find its way between modes. Where 32,000 draws aren't worth 1000, the 500
/// that are resampled repeat each other, and take Metropolis steps (group_moves.h). Z is the mean
/// of w over as many draws of q as tell it to 0.02 nats, of 32,000 at most. Where the two
/// contradict each other at x_o, as when it is like no simulation, the powers are moved towards
/// those of q alone, (1, 0), until kSmallestEfficiency of q's draws remain.
#pragma once

#include "inference/direct_posterior.h"
#include "inference/surrogate_posterior.h"
#include "inference/weighted_population.h"

namespace npdr::inference {

/// Log densities of both networks at points, over the prior: log q(u | z_o) / p(u) and
/// log l(z_o | u), (n).
struct PoolEvidence {
  Vector posterior;
  Vector likelihood;

  /// log w(u), (n). Where q has no density, or a network says NaN, so small that it weighs nothing
  /// beside any other.
  Vector log_weights(PoolPowers powers) const;
};

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

  /// The powers, and log Z [nats], at x_o.
  PoolPowers powers() const;
  double log_normalizer() const;

  /// Share of p(u) l(z_o | u) / Z, the posterior of l alone, that the pool has missed
  /// (missed_share.h), since q has nothing there. Takes the time of some thousand draws.
  double missed_share() const;

  /// q alone, whose draws are candidates.
  const Posterior& importance_proposal() const override { return posterior_; }
  PoolEvidence evidence(const RowMatrix& theta) const;

 private:
  struct Known;
  struct Group;

  PoolEvidence evidence(const RowMatrix& theta, const Vector& log_q) const;
  template <typename Test>
  WeightedPopulation candidates(StreamId batch, const Test& is_enough) const;
  Group draw_group(const StreamId& id) const;
  void move(RowMatrix& theta, Stream& stream) const;
  PoolPowers usable_powers() const;
  double estimate_log_normalizer() const;

  DirectPosterior posterior_;
  SurrogatePosterior likelihood_;
  std::unique_ptr<Known> known_;
};

/// The parts of NPE's networks alone.
NetworkParts posterior_parts(NetworkParts parts);
/// The parts of NLE's networks, of the same seed; `parts` has a likelihood.
NetworkParts likelihood_parts(NetworkParts parts);

}  // namespace npdr::inference
