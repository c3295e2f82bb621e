/// A posterior p(theta | x_o), whatever method made it.
#pragma once

#include <memory>
#include <optional>

#include "core/constants.h"
#include "core/random.h"
#include "core/types.h"
#include "inference/prior.h"

namespace npdr::inference {

/// Quality of samples that didn't come from the posterior directly.
struct SamplerReport {
  Vector r_hat;  ///< (D) of Markov chains, in the space of u; empty: there were none
  Vector ess;    ///< (D) effective sample sizes of the chains; (1) that of importance weights
  Index num_evaluations = 0;  ///< of the density
  /// log Z [nats], which relative_log_prob() lacks, by the weights of the candidates; NaN: unknown.
  double log_normalizer = kNaN;
};

/// Samples of a posterior, and how good they are where that isn't certain.
struct Samples {
  RowMatrix theta;  ///< (n, D)
  std::optional<SamplerReport> report = {};
};

/// Posterior over theta, given one observation. Const calls are thread-safe.
class Posterior {
 public:
  virtual ~Posterior() = default;
  virtual const Prior& prior() const = 0;

  /// n samples of theta, all inside of the prior's support unless the method says otherwise
  /// (particle_posterior.h). Sample i depends on `id` and i alone:
  /// not on n, nor on the number of threads.
  virtual Samples draw(Index n, const StreamId& id) const = 0;
  /// The samples alone, (n, D).
  RowMatrix sample(Index n, const StreamId& id) const { return draw(n, id).theta; }

  /// log p(theta | x_o) in nats, (n); -infinity outside of the prior's support.
  virtual Vector log_prob(const RowMatrix& theta) const = 0;
  /// log_prob() up to a constant, (n), in nats: cheaper where the constant has to be estimated.
  virtual Vector relative_log_prob(const RowMatrix& theta) const { return log_prob(theta); }

  /// The theta (D) with the largest posterior density: the best of 1000 samples, refined by NLopt
  /// (Rowan 1990, subplex) in the space where the prior is N(0, I). Throws Error where the density
  /// is no number at any of them.
  virtual Vector map(const StreamId& id) const;

 protected:
  /// The likeliest of 1000 samples, (D). Throws Error where the density is no number at any of
  /// them.
  Vector best_sample(const StreamId& id) const;
};

}  // namespace npdr::inference
