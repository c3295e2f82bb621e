#include "inference/surrogate_posterior.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/error.h"
#include "core/log_sum_exp.h"
#include "inference/direct_posterior.h"
#include "inference/ensemble.h"
#include "inference/log_normalizer.h"
#include "inference/row_blocks.h"
#include "inference/samplers/tempered_chains.h"
#include "inference/standard_normal.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
// Written once, by whoever needs it first.
struct SurrogatePosterior::Normalizer {
  std::once_flag once;
  double log_z = 0.0;
};

SurrogatePosterior::SurrogatePosterior(NetworkParts given)
    : NetworkPosterior(std::move(given)), normalizer_(std::make_unique<Normalizer>()) {
  for (Index m = 0; m < parts().estimator.num_networks; ++m) members_.push_back(make_member(m));
  if (parts().role() == NetworkRole::ratio && members_.size() > 1) {
    throw ShapeError("posterior: ratios are known up to a constant, and can't be averaged");
  }
  require_weights(parts(), std::visit([](const auto& n) { return n.num_parameters(); },
                                      members_.front().network));
  parts().transform.apply(parts().x_o.transpose(), z_);
  z_rows_ = z_.replicate(kBlockRows, 1);
}

SurrogatePosterior::~SurrogatePosterior() = default;

SurrogatePosterior::Member SurrogatePosterior::make_member(Index m) const {
  NetworkParts one = network_of(parts(), m);
  if (one.role() == NetworkRole::likelihood) {
    return {make_network(one), std::move(one.parameters)};
  }
  return {RatioEstimator<float>(one.estimator, prior().dimension(), one.transform.num_outputs()),
          std::move(one.parameters)};
}

void SurrogatePosterior::evaluate(const Member& member, const RowMatrixF& u,
                                  VectorF& values) const {
  if (const auto* const ratio = std::get_if<RatioEstimator<float>>(&member.network)) {
    RatioScratch<float> scratch;
    ratio->logits(member.weights, u, z_, scratch, values);
  } else {
    const auto& likelihood = std::get<EmbeddedEstimator<float>>(member.network);
    auto scratch = likelihood.make_scratch();
    likelihood.log_prob(member.weights, z_rows_, u, scratch, values);
  }
}

Vector SurrogatePosterior::surrogate(const RowMatrix& u) const {
  Vector result;
  evaluate_in_blocks(
      u.cast<float>(),
      [&](const RowMatrixF& block, VectorF& values) {
        LogMeanExp mean;
        for (const Member& member : members_) {
          evaluate(member, block, values);
          mean.add(values);
        }
        values = mean.result();
      },
      result);
  return result;
}

Vector SurrogatePosterior::log_density(const RowMatrix& u) const {
  return surrogate(u) + log_standard_normal(u);
}

Samples SurrogatePosterior::draw(Index n, const StreamId& id) const {
  const SamplerConfig& sampler = std::get<SurrogateParts>(parts().of_role).sampler;
  if (sampler.kind == SamplerKind::importance) {
    return draw_by_importance(n, sampler.num_candidates, id);
  }
  TemperedDraws draws = sample_tempered([&](const RowMatrix& u) { return surrogate(u); },
                                        prior().dimension(), n, sampler, id);
  return {prior().to_theta(draws.u), std::move(draws.report)};
}

Samples SurrogatePosterior::draw_by_importance(Index n, Index num_points,
                                               const StreamId& id) const {
  RowMatrix points =
      draw_standard_normal(num_points, prior().dimension(), within(id, "candidates"));
  Vector log_weights = surrogate(points);
  const WeightedPopulation candidates(std::move(points), std::move(log_weights));
  if (!candidates.has_weight()) throw Error("posterior: its density is 0 or infinite throughout");
  SamplerReport report;
  report.ess = Vector::Constant(1, candidates.effective_size());
  report.num_evaluations = candidates.size();
  return {prior().to_theta(candidates.draw(n, id)), report};
}

double SurrogatePosterior::log_normalizer() const {
  std::call_once(normalizer_->once, [&] { normalizer_->log_z = estimate_log_normalizer(); });
  return normalizer_->log_z;
}

double SurrogatePosterior::estimate_log_normalizer() const {
  constexpr Index num_samples = 1000;
  const StreamId id{parts().structure_seed, "normaliser", 0, 0, 0};
  return inference::log_normalizer([&](const RowMatrix& u) { return log_density(u); },
                                   prior().to_normal(sample(num_samples, id)),
                                   named(id, "normaliser_points"));
}

Vector SurrogatePosterior::relative_log_prob(const RowMatrix& theta) const {
  return log_density(prior().to_normal(theta)) + prior().log_det_to_normal(theta);
}

Vector SurrogatePosterior::log_prob(const RowMatrix& theta) const {
  return relative_log_prob(theta).array() - log_normalizer();
}

}  // namespace npdr::inference
