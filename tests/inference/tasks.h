/// Inference tasks with known posteriors, and a loop over rounds that keeps everything in memory.
#pragma once

#include <Eigen/LU>
#include <functional>
#include <vector>

#include "inference/algorithms/posterior_estimation.h"

namespace npdr::inference {

/// x in memory.
class MatrixSource : public FeatureSource {
 public:
  explicit MatrixSource(RowMatrixF x) : x_(std::move(x)) {}
  Index num_rows() const override { return x_.rows(); }
  Index num_features() const override { return x_.cols(); }
  void gather(std::span<const std::uint32_t> rows, std::uint64_t, RowMatrixF& x) const override {
    x.resize(static_cast<Index>(rows.size()), x_.cols());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      x.row(static_cast<Index>(i)) = x_.row(rows[i]);
    }
  }

 private:
  RowMatrixF x_;
};

/// x ~ p(x | theta), with the stream of its row.
using TestSimulator = std::function<VectorF(const Vector& theta, Stream& stream)>;

inline RowMatrix sample_prior(const Prior& prior, Index n, std::uint64_t seed) {
  RowMatrix theta(n, prior.dimension());
  for (Index i = 0; i < n; ++i) {
    Stream stream({seed, "prior", 1, static_cast<std::uint64_t>(i), 0});
    theta.row(i) = prior.sample(stream).transpose();
  }
  return theta;
}

inline RowMatrixF simulate(const TestSimulator& simulator, const RowMatrix& theta,
                           std::uint64_t seed, std::uint64_t round) {
  RowMatrixF x;
  for (Index i = 0; i < theta.rows(); ++i) {
    Stream stream({seed, "simulate", round, static_cast<std::uint64_t>(i), 0});
    const VectorF row = simulator(theta.row(i).transpose(), stream);
    if (i == 0) x.resize(theta.rows(), row.size());
    x.row(i) = row.transpose();
  }
  return x;
}

/// All rounds of NPE at x_o.
inline DirectPosterior infer(const PosteriorEstimationConfig& config, const Prior& prior,
                             const TestSimulator& simulator, const VectorF& x_o,
                             std::uint64_t seed) {
  RoundData data;
  data.prior = &prior;
  data.x_o = x_o;
  RowMatrixF x(0, x_o.size());
  std::optional<DirectPosterior> posterior;
  const bool analytic = resolve_loss(config.algorithm, config.estimator) == "analytic";
  const Index n = config.algorithm.num_simulations;
  for (Index round = 1; round <= config.algorithm.num_rounds; ++round) {
    const auto r = static_cast<std::uint64_t>(round);
    const RowMatrix theta = round == 1 ? sample_prior(prior, n, seed)
                                       : propose(config, *posterior, n, {seed, "propose", r, 0, 0});
    if (round > 1 && analytic) data.proposals.push_back(proposal_mixture(*posterior));
    x.conservativeResize(x.rows() + n, Eigen::NoChange);
    x.bottomRows(n) = simulate(simulator, theta, seed, r);
    data.theta.conservativeResize(x.rows(), prior.dimension());
    data.theta.bottomRows(n) = theta;
    data.round.insert(data.round.end(), static_cast<std::size_t>(n),
                      static_cast<std::uint32_t>(round));
    const MatrixSource source(x);
    data.x = &source;
    TrainingState state;
    posterior = estimate_posterior(config, data, posterior ? &*posterior : nullptr,
                                   {seed, "train", r, 0, 0}, state,
                                   [](const TrainingState&) { return true; });
  }
  return *posterior;
}

/// theta ~ N(0, I) in D dimensions, x = theta + N(0, 0.3^2 I) mixed by a fixed matrix A:
/// p(theta | x_o) = N(m, C), C = (I + A'A / s^2)^-1, m = C A' x_o / s^2.
struct LinearGaussian {
  Index dimension;
  Eigen::MatrixXd a;
  double noise = 0.3;

  explicit LinearGaussian(Index d) : dimension(d), a(Eigen::MatrixXd::Identity(d, d)) {
    for (Index i = 0; i + 1 < d; ++i) a(i, i + 1) = 0.5;
  }
  Prior prior() const {
    std::vector<Marginal> marginals;
    for (Index d = 0; d < dimension; ++d) {
      marginals.push_back({"theta_" + std::to_string(d), "1", Marginal::Kind::normal, 0.0, 1.0});
    }
    return Prior(marginals);
  }
  TestSimulator simulator() const {
    return [this](const Vector& theta, Stream& stream) {
      Vector x = a * theta;
      for (double& v : x) v += noise * stream.normal();
      return VectorF(x.cast<float>());
    };
  }
  Eigen::MatrixXd covariance() const {
    return (Eigen::MatrixXd::Identity(dimension, dimension) + a.transpose() * a / (noise * noise))
        .inverse();
  }
  Vector mean(const VectorF& x_o) const {
    return covariance() * a.transpose() * x_o.cast<double>() / (noise * noise);
  }
};

}  // namespace npdr::inference
