#include <numeric>

#include "inference/algorithms/likelihood_objective.h"
#include "inference/algorithms/ratio_objective.h"
#include "tests/inference/algorithms/objective_check.h"

namespace npdr::inference {
namespace {

EstimatorConfig small(EstimatorKind kind) {
  EstimatorConfig config;
  config.kind = kind;
  config.num_transforms = 2;
  config.num_components = 3;
  config.hidden_features = 8;
  return config;
}

TEST(LikelihoodObjective, GradientEqualsCentralDifferences) {
  using Of = LikelihoodObjective::Of;
  const SmallBatch small_batch;
  std::vector<std::uint32_t> all(60);
  std::iota(all.begin(), all.end(), 0u);
  VectorF weights(60);
  for (Index i = 0; i < 60; ++i) weights(i) = 0.1f * static_cast<float>(i % 7);
  for (const EstimatorKind kind : kinds_that_give(Estimate::density)) {
    for (const Of of : {Of::u_given_z, Of::z_given_u}) {
      const auto network = make_network(small(kind), 2, {}, 2, 1);
      LikelihoodObjective objective(of, network, small_batch.transform, small_batch.data, all,
                                    weights);
      expect_slope_is_gradient(objective, network.initial_parameters({1, "initial", 0, 0, 0}),
                               small_batch.batch(), name_of(kind));
    }
  }
}

TEST(LikelihoodObjective, RowsCountAsOftenAsTheirWeightsSay) {
  // A row with weight 2 counts as two rows.
  const SmallBatch small_batch;
  const auto network = make_network(small(EstimatorKind::maf), 2, {}, 2, 1);
  const auto parameters = network.initial_parameters({1, "initial", 0, 0, 0});
  const auto loss_of = [&](std::vector<std::uint32_t> rows, const VectorF& weights) {
    const auto count = static_cast<std::uint32_t>(rows.size());
    LikelihoodObjective objective(LikelihoodObjective::Of::u_given_z, network,
                                  small_batch.transform, small_batch.data, std::move(rows),
                                  weights);
    std::vector<std::uint32_t> batch(count);
    std::iota(batch.begin(), batch.end(), 0u);
    return objective.loss(parameters, {batch, 1, 0}, nullptr);
  };
  VectorF weights = VectorF::Ones(60);
  weights(7) = 2.0f;
  EXPECT_NEAR(2.0 * loss_of({3, 7}, weights), 3.0 * loss_of({3, 7, 7}, {}), 1e-5);
}

TEST(RatioObjective, GradientEqualsCentralDifferences) {
  const SmallBatch small_batch;
  const EstimatorConfig config = small(EstimatorKind::resnet);
  const RatioEstimator<float> network(config, 2, 2);
  for (const Algorithm kind : {Algorithm::nre_a, Algorithm::nre_b}) {
    RatioObjective objective({.kind = kind, .num_atoms = 5}, network, small_batch.transform,
                             small_batch.data, {1, "train", 2, 0, 0});
    expect_slope_is_gradient(objective, network.initial_parameters({1, "initial", 0, 0, 0}),
                             small_batch.batch(), name_of(kind));
  }
}

}  // namespace
}  // namespace npdr::inference
