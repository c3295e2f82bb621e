#include "inference/posterior.h"

#include <algorithm>
#include <limits>
#include <nlopt.hpp>

#include "core/error.h"
#include "core/parallel.h"
#include "inference/estimators/mixture_density_network.h"

namespace npdr::inference {
namespace {

// Rows are evaluated in blocks of this many, the last one padded: a row's bits then depend neither
// on how many others there are nor on the thread that computes it.
constexpr Index kBlock = 64;

Index num_blocks(Index rows) { return (rows + kBlock - 1) / kBlock; }

}  // namespace

EmbeddedEstimator<float> make_network(const EstimatorConfig& config, Index num_inputs,
                                      Index trained_features, Index dimension,
                                      std::uint64_t structure_seed) {
  const StreamId structure{structure_seed, "network_structure", 0, 0, 0};
  return {num_inputs, trained_features, config, dimension, structure};
}

Vector Posterior::map(const StreamId& id) const {
  constexpr Index num_starts = 1000;
  constexpr int max_evaluations = 3000;
  constexpr double farthest = 8.0;  // |u| within which the prior has all of its mass
  const RowMatrix starts = sample(num_starts, id);
  Index best = 0;
  log_prob(starts).maxCoeff(&best);
  const Index d = starts.cols();
  const Vector start = prior().to_normal(starts.middleRows(best, 1)).row(0).transpose();

  nlopt::opt search(nlopt::LN_SBPLX, static_cast<unsigned>(d));
  search.set_lower_bounds(-farthest);
  search.set_upper_bounds(farthest);
  search.set_initial_step(0.1);
  search.set_xtol_rel(1e-6);
  search.set_maxeval(max_evaluations);
  const nlopt::vfunc objective = [](const std::vector<double>& u, std::vector<double>&,
                                    void* self) {
    const auto& posterior = *static_cast<const Posterior*>(self);
    const auto width = static_cast<Index>(u.size());
    const RowMatrix theta =
        posterior.prior().to_theta(Eigen::Map<const RowMatrix>(u.data(), 1, width));
    const double value = posterior.log_prob(theta)(0);
    return std::isfinite(value) ? value : std::numeric_limits<double>::lowest();
  };
  search.set_max_objective(objective, const_cast<Posterior*>(this));
  std::vector<double> u(start.begin(), start.end());
  for (double& value : u) value = std::clamp(value, -farthest, farthest);
  double value = 0.0;
  search.optimize(u, value);
  return prior().to_theta(Eigen::Map<const RowMatrix>(u.data(), 1, d)).row(0).transpose();
}

DirectPosterior::DirectPosterior(DirectPosteriorParts parts)
    : parts_(std::move(parts)),
      network_(std::make_shared<const EmbeddedEstimator<float>>(
          make_network(parts_.estimator, parts_.transform.num_outputs(), parts_.trained_features,
                       parts_.prior.dimension(), parts_.structure_seed))) {
  if (parts_.parameters.size() != network_->num_parameters() ||
      parts_.x_o.size() != parts_.transform.num_inputs()) {
    throw ShapeError("posterior: " + std::to_string(parts_.parameters.size()) + " weights and " +
                     std::to_string(parts_.x_o.size()) + " features, must be " +
                     std::to_string(network_->num_parameters()) + " and " +
                     std::to_string(parts_.transform.num_inputs()));
  }
  parts_.transform.apply(parts_.x_o.transpose(), x_);
}

RowMatrix DirectPosterior::sample(Index n, const StreamId& id) const {
  RowMatrix u(num_blocks(n) * kBlock, parts_.prior.dimension());
  parallel_for(num_blocks(n), [&](Index b) {
    StreamId block = id;
    block.row += static_cast<std::uint64_t>(b * kBlock);
    u.middleRows(b * kBlock, kBlock) =
        network_->sample(parts_.parameters, x_, kBlock, block).cast<double>();
  });
  return parts_.prior.to_theta(u.topRows(n));
}

Vector DirectPosterior::log_prob(const RowMatrix& theta) const {
  const Index n = theta.rows();
  const RowMatrixF u = parts_.prior.to_normal(theta).cast<float>();
  Vector result(n);
  parallel_for(num_blocks(n), [&](Index b) {
    const Index rows = std::min(kBlock, n - b * kBlock);
    RowMatrixF block(kBlock, u.cols());
    block.topRows(rows) = u.middleRows(b * kBlock, rows);
    block.bottomRows(kBlock - rows).rowwise() = u.row(n - 1);
    auto scratch = network_->make_scratch();
    VectorF log_prob;
    network_->log_prob(parts_.parameters, block, x_, scratch, log_prob);
    result.segment(b * kBlock, rows) = log_prob.head(rows).cast<double>();
  });
  return result + parts_.prior.log_det_to_normal(theta);
}

DirectPosterior DirectPosterior::given(const VectorF& x) const {
  DirectPosteriorParts parts = parts_;
  parts.x_o = x;
  return DirectPosterior(std::move(parts));
}

GaussianMixture DirectPosterior::mixture() const {
  const auto* mixtures = dynamic_cast<const MixtureDensityNetwork<float>*>(&network_->estimator());
  if (mixtures == nullptr) throw Error("posterior: its density estimator is not a mixture");
  auto scratch = network_->make_scratch();
  auto& heads = static_cast<MixtureScratch<float>&>(*scratch.estimator);
  mixtures->forward_heads(parts_.parameters, network_->embed(parts_.parameters, x_, scratch),
                          heads);
  return mixtures->mixture(heads, 0);
}

}  // namespace npdr::inference
