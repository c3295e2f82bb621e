/// NPE-C (SNPE-C, APT): neural posterior estimation over rounds with a corrected proposal.
///
/// Source: Greenberg, Nonnenmacher and Macke 2019. Simulations of round 1 come from the prior and
/// train q(u | x) by maximum likelihood. Those of later rounds come from the posterior estimate at
/// x_o; all rounds' simulations are then used with one of two losses:
///  - atomic (atomic_loss.h), for any density estimator;
///  - analytic (mixture_correction_loss.h), for mixtures of Gaussians: every row is corrected for
///    the proposal of its own round.
#pragma once

#include <vector>

#include "inference/algorithms/algorithm_config.h"
#include "inference/algorithms/mixture_correction_loss.h"
#include "inference/algorithms/training_data.h"
#include "inference/estimators/embedded_estimator.h"
#include "inference/feature_transform.h"
#include "inference/training/trainer.h"

namespace npdr::inference {

/// The mixture that propose() draws u from when the loss is analytic. Throws Error when the
/// posterior's estimator isn't one.
GaussianMixture proposal_mixture(const NetworkPosterior& posterior);

/// The objective of NPE-C over one round's training: the analytic loss where the data have
/// proposals, else the atomic one.
class NpeC : public Objective {
 public:
  /// Keeps references to its arguments. Throws Error for proposals with a network that isn't a
  /// mixture.
  NpeC(const AlgorithmConfig& config, const EmbeddedEstimator<float>& network,
       const FeatureTransform& transform, const TrainingData& data, const StreamId& id);

  Index num_rows() const override { return data_.u.rows(); }
  double loss(const Parameters<float>& parameters, const Batch& batch,
              Parameters<float>* gradient) override;

 private:
  double maximum_likelihood(const Parameters<float>& parameters, Parameters<float>* gradient);
  double atomic(const Parameters<float>& parameters, const Batch& batch,
                Parameters<float>* gradient);
  double analytic(const Parameters<float>& parameters, const Batch& batch,
                  Parameters<float>* gradient);

  const AlgorithmConfig& config_;
  const EmbeddedEstimator<float>& network_;
  const FeatureTransform& transform_;
  const TrainingData& data_;
  StreamId id_;
  bool only_prior_;  ///< every row comes from the prior: plain maximum likelihood
  std::vector<MixtureCorrection> corrections_;  ///< of rounds 2, 3, ...; analytic loss only
  EmbeddedEstimator<float>::Scratch scratch_;
  RowMatrixF raw_x_;    ///< (n, F)
  RowMatrixF x_;        ///< (n, F or k), transformed
  RowMatrixF u_;        ///< (n, D)
  RowMatrixF atoms_;    ///< (n k, D)
  VectorF log_prob_;    ///< (n k)
  VectorF log_prior_;   ///< (n k)
  VectorF d_log_prob_;  ///< (n k)
};

}  // namespace npdr::inference
