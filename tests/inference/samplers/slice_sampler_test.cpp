#include "inference/samplers/slice_sampler.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>

#include "core/constants.h"
#include "core/error.h"
#include "inference/samplers/chain_diagnostics.h"
#include "tests/inference/gradient_check.h"

namespace npdr::inference {
namespace {

const StreamId kSliceId{3, "slice", 0, 0, 0};

// A Gaussian in D = 3 with correlation 0.95 and deviations 0.01, 1 and 0.1 around (1, -1, 0).
Eigen::Matrix3d covariance() {
  const Eigen::Vector3d deviations(0.01, 1.0, 0.1);
  Eigen::Matrix3d correlation;
  correlation << 1.0, 0.95, 0.0, 0.95, 1.0, 0.0, 0.0, 0.0, 1.0;
  return deviations.asDiagonal() * correlation * deviations.asDiagonal();
}
const Eigen::Vector3d kMean(1.0, -1.0, 0.0);

Vector log_gaussian(const RowMatrix& u) {
  const Eigen::Matrix3d precision = covariance().inverse();
  Vector log_p(u.rows());
  for (Index i = 0; i < u.rows(); ++i) {
    const Eigen::Vector3d x = u.row(i).transpose() - kMean;
    log_p(i) = -0.5 * x.dot(precision * x);
  }
  return log_p;
}

// Moments within four standard errors, whose size follows from the effective sample size: 18
// comparisons of false-alarm rate 6e-5, fixed seed.
TEST(SliceSampler, FindsTheMomentsOfACorrelatedGaussian) {
  const RowMatrix start = random_matrix(50, 3, 1);
  const ChainDraws draws = slice_sample(log_gaussian, start, 100, {}, kSliceId);
  ASSERT_EQ(draws.u.rows(), 5000);
  const ChainDiagnostics diagnostics = diagnose(draws);
  EXPECT_LT(diagnostics.r_hat.maxCoeff(), 1.02);
  EXPECT_GT(diagnostics.ess.minCoeff(), 1000.0);
  const Eigen::RowVector3d mean = draws.u.colwise().mean();
  const RowMatrix centered = draws.u.rowwise() - mean;
  const Eigen::Matrix3d found = centered.transpose() * centered / 5000.0;
  for (Index a = 0; a < 3; ++a) {
    const double variance = covariance()(a, a), n = diagnostics.ess(a);
    EXPECT_NEAR(mean(a), kMean(a), 4.0 * std::sqrt(variance / n)) << a;
    EXPECT_NEAR(found(a, a) / variance, 1.0, 4.0 * std::sqrt(2.0 / n)) << a;
  }
  const double correlation = found(0, 1) / std::sqrt(found(0, 0) * found(1, 1));
  EXPECT_NEAR(correlation, 0.95, 4.0 * (1.0 - 0.95 * 0.95) / std::sqrt(diagnostics.ess(0)));
}

// 0.3 N(-1, 0.3^2) + 0.7 N(1, 0.3^2): stepping out crosses the valley of a few nats.
TEST(SliceSampler, VisitsTwoModesInProportion) {
  const LogDensity two = [](const RowMatrix& u) -> Vector {
    const auto mode = [&](double weight, double mean) -> Eigen::ArrayXd {
      return weight * (-0.5 * ((u.col(0).array() - mean) / 0.3).square()).exp();
    };
    return (mode(0.3, -1.0) + mode(0.7, 1.0)).log();
  };
  const ChainDraws draws = slice_sample(two, random_matrix(100, 1, 2), 100, {}, kSliceId);
  const double upper = (draws.u.array() > 0.0).cast<double>().mean();
  EXPECT_NEAR(upper, 0.7, 4.0 * std::sqrt(0.21 / diagnose(draws).ess(0)));
}

// 0.5 N(0, 0.05^2) + 0.5 N(0.6, 0.1^2) in two dimensions. Chains that begin there in proportion
// stay so, whichever width each of them learns where it is: four standard errors of their number.
TEST(SliceSampler, KeepsTheSharesOfModesOfUnequalWidth) {
  constexpr Index chains = 4000;
  const LogDensity two = [](const RowMatrix& u) -> Vector {
    const auto mode = [&](double mean, double width) -> Eigen::ArrayXd {
      return -0.5 * (u.array() - mean).square().rowwise().sum() / (width * width) -
             2.0 * std::log(width);
    };
    return (mode(0.0, 0.05).exp() + mode(0.6, 0.1).exp()).log();
  };
  RowMatrix start = random_matrix(chains, 2, 3);
  start.topRows(chains / 2) *= 0.05;
  start.bottomRows(chains / 2) = (0.1 * start.bottomRows(chains / 2)).array() + 0.6;
  const ChainDraws draws = slice_sample(two, start, 10, {}, kSliceId);
  const double wide = (draws.u.rowwise().sum().array() > 0.4).cast<double>().mean();
  EXPECT_NEAR(wide, 0.5, 4.0 * std::sqrt(0.25 / chains));
}

// A density with an edge: uniform on (0, 1), 0 elsewhere, and NaN beyond 2.
TEST(SliceSampler, StaysWhereTheDensityIs) {
  const LogDensity uniform = [](const RowMatrix& u) -> Vector {
    return u.col(0).unaryExpr([](double x) {
      if (x > 2.0) return kNaN;
      return x > 0.0 && x < 1.0 ? 0.0 : -kInfinity;
    });
  };
  const ChainDraws draws =
      slice_sample(uniform, RowMatrix::Constant(20, 1, 0.5), 200, {}, kSliceId);
  EXPECT_GT(draws.u.minCoeff(), 0.0);
  EXPECT_LT(draws.u.maxCoeff(), 1.0);
  EXPECT_NEAR(draws.u.mean(), 0.5, 4.0 * std::sqrt(1.0 / 12.0 / diagnose(draws).ess(0)));
}

TEST(SliceSampler, ADrawDependsNeitherOnHowManyFollowNorOnTheBatches) {
  const LogDensity one_by_one = [](const RowMatrix& u) {
    Vector log_p(u.rows());
    for (Index i = 0; i < u.rows(); ++i) log_p(i) = log_gaussian(u.middleRows(i, 1))(0);
    return log_p;
  };
  const RowMatrix start = random_matrix(10, 3, 4);
  const ChainDraws all = slice_sample(log_gaussian, start, 20, {}, kSliceId);
  const ChainDraws some = slice_sample(one_by_one, start, 5, {}, kSliceId);
  EXPECT_EQ(some.u, all.u.topRows(50));
  EXPECT_NE(some.u, slice_sample(log_gaussian, start, 5, {}, {4, "slice", 0, 0, 0}).u);
}

TEST(SliceSampler, RejectsAStartThatCannotBe) {
  const LogDensity nowhere = [](const RowMatrix& u) -> Vector {
    return Vector::Constant(u.rows(), -kInfinity);
  };
  EXPECT_THROW(slice_sample(nowhere, RowMatrix::Zero(2, 1), 5, {}, kSliceId), InputError);
  EXPECT_THROW(slice_sample(log_gaussian, RowMatrix::Zero(2, 3), 5, {.thin = 0}, kSliceId),
               InputError);
}

// Draws of C chains that each follow x' = rho x + sqrt(1 - rho^2) e.
ChainDraws autoregressive(double rho, Index chains, Index length) {
  ChainDraws draws{random_matrix(chains * length, 1, 9), chains, 0};
  for (Index s = 1; s < length; ++s) {
    for (Index c = 0; c < chains; ++c) {
      double& x = draws.u(s * chains + c, 0);
      x = rho * draws.u((s - 1) * chains + c, 0) + std::sqrt(1.0 - rho * rho) * x;
    }
  }
  return draws;
}

// N (1 - rho) / (1 + rho); 10 % is more than three times the scatter at this length.
TEST(ChainDiagnostics, EffectiveSizeOfAnAutoregressiveChainIsKnown) {
  for (const double rho : {0.0, 0.5, 0.9}) {
    const ChainDiagnostics found = diagnose(autoregressive(rho, 10, 4000));
    EXPECT_NEAR(found.ess(0) / (40'000.0 * (1.0 - rho) / (1.0 + rho)), 1.0, 0.1) << rho;
    EXPECT_LT(found.r_hat(0), 1.02) << rho;
  }
}

TEST(ChainDiagnostics, ChainsThatDisagreeAreFound) {
  ChainDraws draws = autoregressive(0.0, 4, 500);
  for (Index s = 0; s < 500; ++s) draws.u(s * 4, 0) += 2.0;
  EXPECT_GT(diagnose(draws).r_hat(0), 1.2);
  EXPECT_LT(diagnose(draws).ess(0), 100.0);
}

TEST(ChainDiagnostics, AreUnknownOfShortChains) {
  EXPECT_TRUE(std::isnan(diagnose(autoregressive(0.0, 4, 3)).r_hat(0)));
}

}  // namespace
}  // namespace npdr::inference
