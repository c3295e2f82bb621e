#include "inference/particle_posterior.h"

#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "inference/samplers/chain_diagnostics.h"

namespace npdr::inference {
namespace {

ParticleParts checked(ParticleParts parts) {
  const Index n = parts.theta.rows();
  if (n < 1 || parts.theta.cols() != parts.prior.dimension() || parts.weights.size() != n ||
      parts.num_chains < 0 || (parts.num_chains > 0 && n % parts.num_chains != 0)) {
    throw ShapeError("posterior: " + std::to_string(n) + " particles of " +
                     std::to_string(parts.theta.cols()) + " parameters, " +
                     std::to_string(parts.weights.size()) + " weights and " +
                     std::to_string(parts.num_chains) + " chains for a prior of " +
                     std::to_string(parts.prior.dimension()) + " parameters don't go together");
  }
  if (!(parts.weights.minCoeff() >= 0.0) || !(parts.weights.sum() > 0.0)) {
    throw InputError("posterior: weights of particles must be >= 0, and not all of them 0");
  }
  return parts;
}

bool weigh_the_same(const Vector& weights) { return weights.minCoeff() == weights.maxCoeff(); }

}  // namespace

ParticlePosterior::ParticlePosterior(ParticleParts given)
    : parts_(checked(std::move(given))),
      points_(parts_.space == ParticleSpace::theta ? parts_.theta
                                                   : parts_.prior.to_normal(parts_.theta)),
      density_(points_, parts_.weights),
      resampler_(parts_.weights) {}

Samples ParticlePosterior::draw(Index n, const StreamId& id) const {
  std::vector<std::uint32_t> order;
  if (weigh_the_same(parts_.weights)) {
    StreamId shuffle = id;
    shuffle.epoch = 1;  // 0 is the rows'
    order = Stream(shuffle).permutation(static_cast<std::uint32_t>(points_.rows()));
  }
  Samples samples{RowMatrix(n, points_.cols()), report()};
  parallel_for(n, [&](Index i) {
    StreamId row = id;
    row.row += static_cast<std::uint64_t>(i);
    Stream stream(row);
    const Index particle = order.empty() ? resampler_.draw(stream.uniform())
                                         : Index{order[static_cast<std::size_t>(i) % order.size()]};
    samples.theta.row(i) = parts_.theta.row(particle);
    if (!parts_.smooth) return;
    const Eigen::RowVectorXd moved =
        points_.row(particle) + density_.sample_kernel(stream).transpose();
    samples.theta.row(i) =
        parts_.space == ParticleSpace::theta ? RowMatrix(moved) : parts_.prior.to_theta(moved);
  });
  return samples;
}

SamplerReport ParticlePosterior::report() const {
  SamplerReport report;
  if (parts_.num_chains == 0) {
    report.ess = Vector::Constant(1, resampler_.effective_size());
    return report;
  }
  const ChainDiagnostics chains = diagnose({points_, parts_.num_chains, 0});
  report.r_hat = chains.r_hat;
  report.ess = chains.ess;
  return report;
}

Vector ParticlePosterior::log_prob(const RowMatrix& theta) const {
  if (theta.cols() != prior().dimension()) {
    throw ShapeError("ParticlePosterior::log_prob: theta has the wrong width");
  }
  if (parts_.space == ParticleSpace::theta) return density_.log_prob(theta);
  return density_.log_prob(prior().to_normal(theta)) + prior().log_det_to_normal(theta);
}

Vector ParticlePosterior::map(const StreamId& id) const {
  if (parts_.mode.size() > 0) return parts_.mode;
  if (parts_.space == ParticleSpace::normal_prior) return Posterior::map(id);
  return best_sample(id);
}

}  // namespace npdr::inference
