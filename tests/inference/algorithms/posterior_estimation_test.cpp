#include "inference/algorithms/posterior_estimation.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "inference/surrogate_posterior.h"
#include "tests/inference/linear_gaussian_check.h"
#include "tests/message_of.h"

namespace npdr::inference {
namespace {

TEST(NpeA, FindsTheLinearGaussianPosteriorOverRounds) {
  expect_linear_gaussian(small_config("npe_a", "mdn", 1, 8000));
  // The estimate of the second round is twice as precise as the posterior, and what is left of its
  // precision after the division has twice its relative error.
  expect_linear_gaussian(small_config("npe_a", "mdn", 2, 4000), 2.0);
}

TEST(NpeB, FindsTheLinearGaussianPosteriorOverRounds) {
  expect_linear_gaussian(small_config("npe_b", "maf", 2, 2000));
}

TEST(NpeC, SplinesFindTheLinearGaussianPosterior) {
  expect_linear_gaussian(small_config("npe_c", "nsf", 1, 4000));
}

TEST(Nle, FindsTheLinearGaussianPosterior) {
  expect_linear_gaussian(small_config("nle", "maf", 1, 4000));
  expect_linear_gaussian(small_config("nle", "maf", 2, 2000));
}

TEST(NreA, FindsTheLinearGaussianPosterior) {
  expect_linear_gaussian(small_config("nre_a", "resnet", 1, 4000), 2.0);  // as NRE-B below
}

TEST(NreB, FindsTheLinearGaussianPosteriorOverRounds) {
  // A classifier learns the ratio of densities less accurately than a density.
  expect_linear_gaussian(small_config("nre_b", "resnet", 1, 4000), 2.0);
  expect_linear_gaussian(small_config("nre_b", "resnet", 2, 2000), 2.0);
}

TEST(Algorithms, SayWhichEstimatorsSuitThem) {
  EXPECT_TRUE(
      says(message_of<InputError>([] { check_estimator("nre_b", {}); }),
           {"density_estimator.kind = 'maf'", "must be one of resnet with algorithm 'nre_b'"}));
  EXPECT_EQ(canonical_algorithm("bayessim"), "npe_a");
  EXPECT_EQ(canonical_algorithm("snle"), "nle");
}

}  // namespace
}  // namespace npdr::inference
