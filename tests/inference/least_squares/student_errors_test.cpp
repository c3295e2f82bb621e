#include "inference/least_squares/student_errors.h"

#include <gtest/gtest.h>

#include "core/constants.h"
#include "core/random.h"

namespace npdr::inference {
namespace {

RowMatrix normal_errors(Index rows, const Vector& scales, std::uint64_t seed) {
  Stream stream({seed, "student_errors_test", 0, 0, 0});
  RowMatrix errors(rows, scales.size());
  for (Index i = 0; i < rows; ++i) {
    for (Index c = 0; c < scales.size(); ++c) errors(i, c) = scales(c) * stream.normal();
  }
  return errors;
}

TEST(StudentErrors, ScalesHaveTheSmallestCost) {
  const StudentErrors noise{.smallest_scales = Vector::Constant(2, 1e-6)};
  const RowMatrix errors = normal_errors(500, Vector{{0.3, 20.0}}, 1);
  const Vector scales = noise.scales(errors);
  const double least = noise.cost(errors, scales);
  for (const double factor : {0.97, 1.03}) {
    EXPECT_GT(noise.cost(errors, Vector{{factor * scales(0), scales(1)}}), least);
    EXPECT_GT(noise.cost(errors, Vector{{scales(0), factor * scales(1)}}), least);
  }
  // Of Gaussian errors: E[(nu + 1) z^2 / (nu + z^2)] = 1 at s = 0.833 of their deviation, by
  // quadrature; the standard error of 500 is 4 %.
  EXPECT_NEAR(scales(0) / 0.3, 0.833, 0.12);
  EXPECT_NEAR(scales(1) / 20.0, 0.833, 0.12);
}

TEST(StudentErrors, AScaleIsNeverBelowTheSmallest) {
  const StudentErrors noise{.smallest_scales = Vector{{0.5}}};
  const RowMatrix small = normal_errors(100, Vector{{0.1}}, 2);
  EXPECT_EQ(noise.scales(small)(0), 0.5);
  EXPECT_EQ(noise.scales(RowMatrix::Zero(100, 1))(0), 0.5);
}

TEST(StudentErrors, ScoresAreDerivativesOfTheCost) {
  const StudentErrors noise{.smallest_scales = Vector::Constant(2, 1e-6)};
  RowMatrix errors = normal_errors(5, Vector{{1.0, 3.0}}, 3);
  const Vector scales{{0.7, 2.5}};
  const RowMatrix scores = noise.scores(errors, scales);
  constexpr double step = 1e-5;
  for (Index i = 0; i < errors.rows(); ++i) {
    for (Index c = 0; c < errors.cols(); ++c) {
      const double at = errors(i, c);
      errors(i, c) = at + step;
      const double above = noise.cost(errors, scales);
      errors(i, c) = at - step;
      const double below = noise.cost(errors, scales);
      errors(i, c) = at;
      EXPECT_NEAR(scores(i, c) / scales(c), (above - below) / (2.0 * step), 1e-7);
    }
  }
}

TEST(StudentErrors, CurvaturesAreMeanDerivativesOfScores) {
  const StudentErrors noise{.smallest_scales = Vector::Constant(1, 1e-6)};
  const RowMatrix errors = normal_errors(50, Vector{{1.0}}, 4);
  const Vector scales{{0.8}};
  constexpr double step = 1e-5;
  const RowMatrix above = noise.scores(errors.array() + step, scales);
  const RowMatrix below = noise.scores(errors.array() - step, scales);
  const double slope = scales(0) * (above - below).mean() / (2.0 * step);
  EXPECT_NEAR(noise.curvatures(errors, scales)(0), slope, 1e-7);
}

TEST(StudentErrors, CostOfErrorsThatAreNotFiniteIsInfinite) {
  const StudentErrors noise{.smallest_scales = Vector::Ones(1)};
  EXPECT_EQ(noise.cost(RowMatrix::Constant(3, 1, kNaN), Vector::Ones(1)), kInfinity);
}

}  // namespace
}  // namespace npdr::inference
