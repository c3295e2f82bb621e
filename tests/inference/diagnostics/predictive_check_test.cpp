#include "inference/diagnostics/predictive_check.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/inference/diagnostics/samples.h"

namespace npdr::inference {
namespace {

TEST(PredictiveCheck, TailsAreTwoSided) {
  RowMatrix summaries(99, 2);
  summaries.col(0) = Vector::LinSpaced(99, 1.0, 99.0);
  summaries.col(1) = Vector::LinSpaced(99, 1.0, 99.0);
  const RowMatrixF features = gaussian(99, 3, 1).cast<float>();
  const PredictiveCheck found =
      check_prediction(summaries, Vector{{21.0, 79.0}}, features, VectorF::Zero(3));
  EXPECT_DOUBLE_EQ(found.summary_p_value(0), 2.0 * 22.0 / 100.0);
  EXPECT_DOUBLE_EQ(found.summary_p_value(1), 2.0 * 22.0 / 100.0);
}

TEST(PredictiveCheck, OneUnusualSummaryIsEnough) {
  const RowMatrix summaries = gaussian(1000, 10, 1);
  const RowMatrixF features = gaussian(1000, 3, 2).cast<float>();
  Vector observed = Vector::Zero(10);
  EXPECT_GT(check_prediction(summaries, observed, features, VectorF::Zero(3)).p_value, 0.01);
  observed(4) = -7.0;
  EXPECT_LT(check_prediction(summaries, observed, features, VectorF::Zero(3)).p_value, 1e-3);
}

TEST(PredictiveCheck, ASummaryThatHardlyVariesIsNotUnusualByItself) {
  RowMatrix summaries = RowMatrix::Zero(200, 2);
  summaries.topLeftCorner(20, 1).setOnes();  // a count that is mostly 0
  const RowMatrixF features = gaussian(200, 3, 2).cast<float>();
  const auto p_of = [&](double observed) {
    return check_prediction(summaries, Vector{{observed, 0.0}}, features, VectorF::Zero(3)).p_value;
  };
  EXPECT_GT(p_of(0.0), 0.1);
  EXPECT_GT(p_of(1.0), 0.1) << "as a tenth of the predictions";
  const double rarest = 2.0 / 201.0;  // of 200 predictions without a smooth tail
  EXPECT_DOUBLE_EQ(p_of(50.0), rarest);
  const Vector off{{0.0, 1.0}};
  EXPECT_DOUBLE_EQ(check_prediction(summaries, off, features, VectorF::Zero(3)).p_value, rarest)
      << "no prediction ever had it";
}

// Deviations of series whose noise has a scale of its own prior: summaries with heavy tails, many
// at once. Of 1000 trials 10 may say p < 0.01, and as many more by chance: the limit is at 4
// standard errors, false alarms of this test 1 in 10,000. The smallest p-value of a summary times
// their number gives 60.
TEST(PredictiveCheck, FalseAlarmsOfManyHeavyTailsAreRare) {
  constexpr Index trials = 1000, n = 200, count = 80;
  const RowMatrix features = gaussian(n + 1, 1, 1);
  Index alarms = 0;
  for (Index trial = 0; trial < trials; ++trial) {
    const auto seed = static_cast<std::uint64_t>(10 + trial);
    RowMatrix summaries = gaussian(n + 1, count, seed);
    const RowMatrix scales = gaussian(n + 1, 4, seed + trials).array().exp();
    for (Index s = 0; s < count; ++s) summaries.col(s).array() *= scales.col(s % 4).array();
    const PredictiveCheck found =
        check_prediction(summaries.topRows(n), summaries.row(n), features.topRows(n).cast<float>(),
                         features.row(n).cast<float>());
    alarms += found.p_value < 0.01 ? 1 : 0;
  }
  EXPECT_LE(alarms, 10 + 4 * 3);
}

TEST(PredictiveCheck, SoAreFeaturesThatAreUnusualTogether) {
  const RowMatrix summaries = gaussian(1000, 2, 1);
  const RowMatrixF features = gaussian(1000, 20, 2).cast<float>();
  const VectorF observed = VectorF::Constant(20, 2.0f);
  EXPECT_LT(check_prediction(summaries, Vector::Zero(2), features, observed).p_value, 1e-3);
}

TEST(PredictiveCheck, RejectsShapesThatDontGoTogether) {
  const RowMatrixF features = gaussian(100, 3, 1).cast<float>();
  EXPECT_THROW(check_prediction(gaussian(99, 2, 1), Vector::Zero(2), features, VectorF::Zero(3)),
               ShapeError);
  EXPECT_THROW(check_prediction(gaussian(100, 2, 1), Vector::Zero(3), features, VectorF::Zero(3)),
               ShapeError);
}

}  // namespace
}  // namespace npdr::inference
