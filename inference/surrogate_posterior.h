/// A posterior whose likelihood, or ratio of likelihood to evidence, a network has learned:
///   log p(u | x_o) = l(u) + log N(u; 0, I) - log Z,
///   l(u) = log q(z_o | u)   (NLE; Papamakarios, Sterratt and Murray 2019),
///   l(u) = f(u, z_o)        (NRE; ratio_loss.h),
/// or log 1/M sum_m exp l_m(u) of an ensemble of likelihoods (ensemble.h). It is sampled by Markov
/// chains that climb from draws of the prior (tempered_chains.h); or, with sampler "importance", by
/// draws of the prior, resampled by their weight exp l.
///
/// log Z, which only log_prob() needs, is estimated once by importance sampling: from a Gaussian
/// around 1000 samples, 1.5 times as wide, mixed with the prior.
#pragma once

#include <variant>

#include "inference/estimators/embedded_estimator.h"
#include "inference/estimators/ratio_estimator.h"
#include "inference/network_posterior.h"

namespace npdr::inference {

class SurrogatePosterior : public NetworkPosterior {
 public:
  /// Throws ShapeError when the parts don't go together.
  explicit SurrogatePosterior(NetworkParts parts);
  ~SurrogatePosterior() override;

  Samples draw(Index n, const StreamId& id) const override;
  Vector log_prob(const RowMatrix& theta) const override;
  Vector relative_log_prob(const RowMatrix& theta) const override;

  /// l(u) + log N(u; 0, I) of each row of u, (n).
  Vector log_density(const RowMatrix& u) const;

 private:
  struct Normalizer;

  Vector surrogate(const RowMatrix& u) const;
  Samples draw_by_importance(Index n, Index num_points, const StreamId& id) const;
  double log_normalizer() const;
  double estimate_log_normalizer() const;

  struct Member {
    std::variant<EmbeddedEstimator<float>, RatioEstimator<float>> network;  ///< of z given u; f
    Parameters<float> weights;
  };
  Member make_member(Index m) const;
  void evaluate(const Member& member, const RowMatrixF& u, VectorF& values) const;

  std::vector<Member> members_;
  RowMatrixF z_;       ///< (1, F or k): x_o, transformed
  RowMatrixF z_rows_;  ///< (kBlockRows, F or k): the same in each row
  std::unique_ptr<Normalizer> normalizer_;
};

}  // namespace npdr::inference
