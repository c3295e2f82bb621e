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
