#include "core/normal.h"

#include <gtest/gtest.h>

#include <cmath>

namespace npdr {
namespace {

TEST(Normal, QuantileHasTheTabulatedValues) {
  EXPECT_DOUBLE_EQ(normal_quantile(0.5), 0.0);
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-15);
  EXPECT_NEAR(normal_quantile(0.0013498980316300933), -3.0, 1e-14);
}

TEST(Normal, QuantileInvertsTheDistributionFunctionFarIntoTheLowerTail) {
  for (double u = -30.0; u <= 5.0; u += 0.37) {
    EXPECT_NEAR(normal_quantile(normal_cdf(u)), u, 1e-9) << u;
  }
}

TEST(Normal, QuantileIsInfiniteOutsideTheOpenUnitInterval) {
  EXPECT_TRUE(std::isinf(normal_quantile(0.0)));
  EXPECT_LT(normal_quantile(0.0), 0.0);
  EXPECT_TRUE(std::isinf(normal_quantile(1.0)));
}

TEST(Normal, LogDensityIntegratesToOne) {
  double sum = 0.0;
  const double step = 1e-3;
  for (double u = -9.0; u < 9.0; u += step) sum += std::exp(log_normal_density(u)) * step;
  EXPECT_NEAR(sum, 1.0, 1e-10);
}

TEST(StudentT, HasTheDensityOfItsClosedForms) {
  // One degree of freedom is Cauchy's distribution; of two the density is (2 + t^2)^(-3/2).
  for (const double t : {0.0, 0.7, -30.0}) {
    EXPECT_NEAR(log_student_t_density(t, 1.0), -std::log(M_PI * (1.0 + t * t)), 1e-13);
    EXPECT_NEAR(log_student_t_density(t, 2.0), -1.5 * std::log(2.0 + t * t), 1e-13);
  }
  // The series for many degrees of freedom goes on where lgamma ends, and on to the Gaussian.
  EXPECT_NEAR(log_student_t_density(1.5, 200.0), log_student_t_density(1.5, 199.9999999), 1e-11);
  EXPECT_NEAR(log_student_t_density(1.5, 1e9), log_normal_density(1.5), 1e-8);
  EXPECT_NEAR(log_student_t_density(1.5, 1e18), log_normal_density(1.5), 1e-14);
}

}  // namespace
}  // namespace npdr
