/// A posterior that consists of weighted samples ("particles") of theta.
///
/// Samples are particles: drawn with replacement in proportion to their weights or, where all weigh
/// the same, without replacement, in a random order that starts over when all have been drawn. With
/// `smooth`, each is moved by a draw of the kernel of kernel_density.h.
///
/// Densities are estimates by those kernels, in one of two spaces:
///  - normal_prior: over u, where the prior is N(0, I) (prior.h), so that no density leaks out of
///    the prior's support: log p(theta) = log k(u(theta)) + log |du / dtheta|;
///  - theta: over theta itself, for methods whose samples may lie outside of the prior, and which
///    may leave parameters at a fixed value: the density is then that of the others alone.
#pragma once

#include <memory>

#include "inference/kernel_density.h"
#include "inference/posterior.h"
#include "inference/weighted_population.h"

namespace npdr::inference {

/// Space in which the density of particles is estimated (above).
enum class ParticleSpace { normal_prior, theta };

/// Everything that a posterior of particles consists of: what a file must hold.
struct ParticleParts {
  Prior prior;
  RowMatrix theta;  ///< (n, D)
  Vector weights;   ///< (n), >= 0 with a sum > 0
  ParticleSpace space = ParticleSpace::normal_prior;
  bool smooth = false;
  /// C > 0: the particles are draws of C Markov chains, draw s of chain c in row s C + c.
  Index num_chains = 0;
  Vector mode = {};  ///< (D) the likeliest theta; empty: it is searched for
};

class ParticlePosterior final : public Posterior {
 public:
  /// Throws ShapeError when the parts don't go together, InputError when there is no density: no
  /// parameter varies, or one particle has all of the weight.
  explicit ParticlePosterior(ParticleParts parts);

  const Prior& prior() const override { return parts_.prior; }
  const ParticleParts& parts() const { return parts_; }

  /// Reports R-hat and effective sizes of chains, else the effective size of the weights.
  Samples draw(Index n, const StreamId& id) const override;

  /// Outside of the prior's support -infinity with normal_prior, not with theta.
  Vector log_prob(const RowMatrix& theta) const override;

  /// The best of 1000 samples where the space is theta: the refined search of the base ends at the
  /// prior's borders.
  Vector map(const StreamId& id) const override;

 private:
  SamplerReport report() const;

  ParticleParts parts_;
  RowMatrix points_;  ///< (n, D) the particles in the space of the kernels
  KernelDensity density_;
  Resampler resampler_;
};

}  // namespace npdr::inference
