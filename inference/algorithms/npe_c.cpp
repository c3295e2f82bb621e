#include "inference/algorithms/npe_c.h"

#include <algorithm>

#include "core/error.h"
#include "inference/algorithms/atomic_loss.h"
#include "inference/direct_posterior.h"
#include "inference/estimators/mixture_density_network.h"
#include "inference/standard_normal.h"

namespace npdr::inference {
namespace {

using Mixtures = MixtureDensityNetwork<float>;

// Adds weight * gradient to row n of dL/dheads.
void add_to_heads(const Mixtures& network, const GaussianMixtureGradient& gradient, double weight,
                  Index n, ColumnMatrixX<float>& d_heads) {
  for (Index k = 0; k < network.num_components(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    const auto add = [&](Index column, double value) {
      d_heads(n, column + k) += static_cast<float>(weight * value);
    };
    add(network.weight_column(), gradient.log_weights(k));
    for (Index row = 0; row < network.dimension(); ++row) {
      add(network.mean_column(row), gradient.means[i](row));
      for (Index col = row; col < network.dimension(); ++col) {
        add(network.factor_column(row, col), gradient.precision_factors[i](row, col));
      }
    }
  }
}

}  // namespace

GaussianMixture proposal_mixture(const NetworkPosterior& posterior) {
  return narrower_than_prior(dynamic_cast<const DirectPosterior&>(posterior).mixture());
}

NpeC::NpeC(const AlgorithmConfig& config, const EmbeddedEstimator<float>& network,
           const FeatureTransform& transform, const TrainingData& data, const StreamId& id)
    : config_(config),
      network_(network),
      transform_(transform),
      data_(data),
      id_(id),
      only_prior_(std::all_of(data.round.begin(), data.round.end(),
                              [](std::uint32_t round) { return round == 1; })),
      corrections_(data.proposals.begin(), data.proposals.end()),
      scratch_(network.make_scratch()) {
  const bool is_mixture = dynamic_cast<const Mixtures*>(&network.estimator()) != nullptr;
  if (!corrections_.empty() && !is_mixture) {
    throw Error("NPE-C: only a mixture can be corrected for proposals by the analytic loss");
  }
}

double NpeC::loss(const Parameters<float>& parameters, const Batch& batch,
                  Parameters<float>* gradient) {
  data_.x->gather(batch.rows, batch.epoch, raw_x_);
  transform_.apply(raw_x_, x_);
  u_.resize(static_cast<Index>(batch.rows.size()), data_.u.cols());
  for (Index i = 0; i < u_.rows(); ++i) {
    u_.row(i) = data_.u.row(batch.rows[static_cast<std::size_t>(i)]);
  }
  if (only_prior_) return maximum_likelihood(parameters, gradient);
  return corrections_.empty() ? atomic(parameters, batch, gradient)
                              : analytic(parameters, batch, gradient);
}

double NpeC::maximum_likelihood(const Parameters<float>& parameters, Parameters<float>* gradient) {
  network_.log_prob(parameters, u_, x_, scratch_, log_prob_);
  if (gradient != nullptr) {
    d_log_prob_.setConstant(u_.rows(), -1.0f / static_cast<float>(u_.rows()));
    network_.backward(parameters, u_, x_, d_log_prob_, scratch_, *gradient);
  }
  return -static_cast<double>(log_prob_.mean());
}

double NpeC::atomic(const Parameters<float>& parameters, const Batch& batch,
                    Parameters<float>* gradient) {
  const Index n = u_.rows();
  const Index k = std::min(config_.num_atoms, n);
  Stream stream(of_batch(id_, "atoms", batch));
  const std::vector<std::uint32_t> atoms = draw_atoms(n, k, stream);
  atoms_.resize(n * k, u_.cols());
  for (Index i = 0; i < n * k; ++i) atoms_.row(i) = u_.row(atoms[static_cast<std::size_t>(i)]);

  network_.log_prob(parameters, atoms_, x_, scratch_, log_prob_);
  log_prior_ = log_standard_normal(atoms_);
  double loss = atomic_loss(log_prob_, log_prior_, k, d_log_prob_);
  if (config_.combined_loss) {
    for (Index i = 0; i < n; ++i) {
      if (data_.round[batch.rows[static_cast<std::size_t>(i)]] != 1) continue;
      loss -= static_cast<double>(log_prob_(i * k)) / static_cast<double>(n);
      d_log_prob_(i * k) -= 1.0f / static_cast<float>(n);
    }
  }
  if (gradient != nullptr) {
    network_.backward(parameters, atoms_, x_, d_log_prob_, scratch_, *gradient);
  }
  return loss;
}

double NpeC::analytic(const Parameters<float>& parameters, const Batch& batch,
                      Parameters<float>* gradient) {
  const auto& network = static_cast<const Mixtures&>(network_.estimator());
  auto& scratch = static_cast<MixtureScratch<float>&>(*scratch_.estimator);
  const Index n = u_.rows();
  const RowMatrixF& context = network_.embed(parameters, x_, scratch_);
  network.log_prob(parameters, u_, context, scratch, log_prob_);
  double loss = -static_cast<double>(log_prob_.mean());
  d_log_prob_.setConstant(n, -1.0f / static_cast<float>(n));
  if (gradient != nullptr) network.accumulate_heads(d_log_prob_, scratch);
  GaussianMixtureGradient d_mixture;
  for (Index i = 0; i < n; ++i) {
    const std::uint32_t round = data_.round[batch.rows[static_cast<std::size_t>(i)]];
    if (round == 1) continue;
    const double log_z = corrections_.at(round - 2).log_normalizer(
        network.mixture(scratch, i), gradient == nullptr ? nullptr : &d_mixture);
    loss += log_z / static_cast<double>(n);
    if (gradient == nullptr) continue;
    add_to_heads(network, d_mixture, 1.0 / static_cast<double>(n), i, scratch.d_heads);
  }
  if (gradient != nullptr) {
    network.backward_heads(parameters, context, scratch, *gradient, network_.d_context(scratch_));
    network_.backward_embedding(parameters, x_, scratch_, *gradient);
  }
  return loss;
}

}  // namespace npdr::inference
