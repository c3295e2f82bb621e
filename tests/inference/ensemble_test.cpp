#include "inference/ensemble.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/constants.h"
#include "core/error.h"
#include "inference/direct_posterior.h"
#include "inference/matrix_features.h"
#include "inference/surrogate_posterior.h"
#include "tests/inference/linear_gaussian_check.h"

namespace npdr::inference {
namespace {

constexpr Index kNetworks = 3;

// Weights of network m, disturbed where they aren't 0: masks must stay what they are.
template <class Network>
Parameters<float> disturbed(const Network& network, Index m) {
  const StreamId id{1, "weights", 0, static_cast<std::uint64_t>(m), 0};
  Parameters<float> weights = network.initial_parameters(id);
  Stream stream(named(id, "disturbance"));
  for (float& weight : weights) {
    if (weight != 0.0f) weight += 0.2f * static_cast<float>(stream.normal());
  }
  return weights;
}

// Of one parameter and one feature.
NetworkParts random_parts(NetworkRole role, EstimatorKind kind) {
  NetworkParts parts{.prior = Prior({{"a", "1", Marginal::Kind::normal, 0.0, 1.0}}),
                     .of_role = role_parts(role),
                     .estimator = {.kind = kind,
                                   .num_networks = kNetworks,
                                   .num_transforms = 2,
                                   .num_components = 2,
                                   .hidden_features = 10},
                     .structure_seed = 5,
                     .transform = {VectorF::Zero(1), VectorF::Ones(1), {}},
                     .parameters = {},
                     .x_o = VectorF::Constant(1, 0.3f)};
  std::vector<Parameters<float>> weights;
  for (Index m = 0; m < kNetworks; ++m) {
    weights.push_back(disturbed(make_network(network_of(parts, m)), m));
  }
  parts.parameters = joined(weights);
  return parts;
}

// Centers of n cells of [-kFar, kFar].
constexpr double kFar = 12.0;
RowMatrix cell_grid(Index n) {
  return Vector::LinSpaced(n, 0.5 - 0.5 * double(n), 0.5 * double(n) - 0.5) *
         (2.0 * kFar / double(n));
}

void expect_mean_of_members(const NetworkParts& parts) {
  const RowMatrix theta = cell_grid(50);
  Vector mean = Vector::Zero(theta.rows());
  for (Index m = 0; m < kNetworks; ++m) {
    const auto one = make_posterior(network_of(parts, m));
    mean += one->relative_log_prob(theta).array().exp().matrix() / kNetworks;
  }
  const Vector density = make_posterior(parts)->relative_log_prob(theta).array().exp();
  EXPECT_LT((density - mean).array().abs().maxCoeff() / mean.maxCoeff(), 1e-5);
}

TEST(Ensemble, DensityIsTheMeanOfItsNetworks) {
  expect_mean_of_members(random_parts(NetworkRole::posterior, EstimatorKind::nsf));
  expect_mean_of_members(random_parts(NetworkRole::posterior, EstimatorKind::mdn));
  expect_mean_of_members(random_parts(NetworkRole::likelihood, EstimatorKind::maf));
}

TEST(Ensemble, MixturesOfItsNetworksAreOne) {
  const DirectPosterior posterior(random_parts(NetworkRole::posterior, EstimatorKind::mdn));
  EXPECT_EQ(posterior.mixture().num_components(), 2 * kNetworks);
  EXPECT_NEAR(posterior.mixture().log_weights.array().exp().sum(), 1.0, 1e-12);
  const RowMatrix theta = cell_grid(50);
  const Vector by_mixture = posterior.mixture().log_prob(posterior.prior().to_normal(theta)) +
                            posterior.prior().log_det_to_normal(theta);
  EXPECT_LT((by_mixture - posterior.log_prob(theta)).array().abs().maxCoeff(), 1e-4);
}

// The distribution function of samples against the integral of the density; the largest distance of
// 30,000 is above 0.013 once in 10^4 times (Kolmogorov).
TEST(Ensemble, SamplesFollowTheMean) {
  const DirectPosterior posterior(random_parts(NetworkRole::posterior, EstimatorKind::nsf));
  constexpr Index cells = 4800, n = 30'000;
  const double width = 2.0 * kFar / cells;
  const RowMatrix theta = cell_grid(cells);
  const Vector mass = posterior.log_prob(theta).array().exp() * width;
  EXPECT_NEAR(mass.sum(), 1.0, 1e-3);
  const RowMatrix samples = posterior.sample(n, {1, "posterior", 0, 0, 0});
  for (Index i = 0; i < cells; i += 50) {
    const double edge = theta(i, 0) + 0.5 * width;
    const auto count = static_cast<double>((samples.array() < edge).count());
    EXPECT_NEAR(count / n, mass.head(i + 1).sum(), 0.013);
  }
}

TEST(Ensemble, SamplesDoNotDependOnTheirNumber) {
  const DirectPosterior posterior(random_parts(NetworkRole::posterior, EstimatorKind::maf));
  const StreamId id{1, "posterior", 0, 0, 0};
  const RowMatrix many = posterior.sample(500, id);
  EXPECT_EQ(posterior.sample(7, id), many.topRows(7));
  EXPECT_EQ(posterior.sample(200, id), many.topRows(200));
}

TEST(Ensemble, LogOfAMeanStandsImpossibleValues) {
  constexpr float none = -std::numeric_limits<float>::infinity();
  LogMeanExp mean;
  mean.add(Eigen::Vector<float, 5>(0.0f, none, 200.0f, kFloatNaN, 0.0f));
  mean.add(Eigen::Vector<float, 5>(0.0f, none, none, 0.0f, kFloatNaN));
  const VectorF result = mean.result();
  EXPECT_FLOAT_EQ(result(0), 0.0f);
  EXPECT_EQ(result(1), none);
  EXPECT_FLOAT_EQ(result(2), 200.0f - std::log(2.0f));
  EXPECT_TRUE(std::isnan(result(3)) && std::isnan(result(4)));
}

TEST(Ensemble, RefusesWeightsOfAnotherNumberOfNetworks) {
  NetworkParts parts = random_parts(NetworkRole::posterior, EstimatorKind::maf);
  parts.estimator.num_networks = 2;
  EXPECT_THROW(make_posterior(parts), ShapeError);
}

// Rounds with several networks: neighbors are of other networks in an order that changes.
TEST(Ensemble, SamplesComeFromTheNetworksInRandomOrder) {
  const DirectPosterior posterior(random_parts(NetworkRole::posterior, EstimatorKind::mdn));
  const RowMatrix samples = posterior.sample(3 * 300, {1, "posterior", 0, 0, 0});
  Index first = 0;
  for (Index m = 0; m < kNetworks; ++m) {
    const auto one = make_posterior(network_of(posterior.parts(), m));
    const RowMatrix own = one->sample(3 * 300, {1, "posterior", 0, 0, 0});
    for (Index k = 0; k < 64; ++k) first += samples(3 * k, 0) == own(64 * m + k, 0) ? 1 : 0;
  }
  EXPECT_EQ(first, 64) << "each group begins with a sample of one network";
}

// The others end with the first, and its error is what is said.
TEST(Ensemble, AnErrorOfOneNetworkEndsAll) {
  const LinearGaussian task(1);
  const Prior prior = task.prior();
  PosteriorEstimationConfig config = small_config(Algorithm::npe_c, EstimatorKind::maf, 1, 500);
  config.estimator.num_networks = 3;
  config.training.max_epochs = 1'000'000;
  config.training.stop_after_epochs = 1'000'000;
  const RowMatrix theta = sample_prior(prior, 500, 1);
  const RowMatrixF x = simulate(task.simulator(), theta, 1, 1);
  const MatrixFeatures source(x);
  const RoundData data{&prior,           &source, theta, std::vector<std::uint32_t>(500, 1),
                       VectorF::Zero(1), {}};
  std::vector<TrainingState> states;
  EXPECT_THROW(estimate_posterior(config, data, {1, "train", 1, 0, 0}, states,
                                  [](Index m, const TrainingState&) -> bool {
                                    if (m == 0) throw Error("no space left");
                                    return true;
                                  }),
               Error);
}

TEST(Ensemble, FindsTheLinearGaussianPosterior) {
  PosteriorEstimationConfig config = small_config(Algorithm::npe_c, EstimatorKind::maf, 2, 2000);
  config.estimator.num_networks = 3;
  expect_linear_gaussian(config);
}

}  // namespace
}  // namespace npdr::inference
