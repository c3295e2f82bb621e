/// The posterior of some parameters, given the others:
///   p(theta_r | theta_g, x_o) = p(theta_r, theta_g | x_o) / p(theta_g | x_o).
/// It is sampled by 400 Markov chains that climb from 20,000 draws of theta_r's prior
/// (tempered_chains.h), whose density is relative_log_prob() of the whole. The first log_prob()
/// estimates the normaliser (log_normalizer.h) from 1000 samples. Particles have the density of
/// their kernels (kernel_density.h), whose conditional is wider than theirs.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "inference/posterior.h"

namespace npdr::inference {

class ConditionalPosterior final : public Posterior {
 public:
  /// Names and values of theta_g. Throws InputError for a name that `whole` doesn't have or that
  /// occurs twice, where nothing is left, and for a value outside of the prior.
  ConditionalPosterior(std::unique_ptr<Posterior> whole,
                       const std::vector<std::pair<std::string, double>>& given);

  /// Of theta_r, in the order of the whole posterior's.
  const Prior& prior() const override { return prior_; }
  /// Throws Error where the density is no number at any of the draws.
  Samples draw(Index n, const StreamId& id) const override;
  Vector log_prob(const RowMatrix& theta) const override;
  Vector relative_log_prob(const RowMatrix& theta) const override;

 private:
  RowMatrix complete(const RowMatrix& theta) const;

  std::unique_ptr<Posterior> whole_;
  std::vector<Index> columns_;  ///< of theta_r
  Eigen::RowVectorXd values_;   ///< (D) of theta_g; 0 of the others
  Prior prior_;
  mutable std::once_flag has_normalizer_;
  mutable double log_z_ = 0.0;
};

}  // namespace npdr::inference
