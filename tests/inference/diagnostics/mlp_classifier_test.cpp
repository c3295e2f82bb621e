#include "inference/diagnostics/mlp_classifier.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "tests/inference/diagnostics/samples.h"

namespace npdr::inference {
namespace {

const StreamId kClassifierId{1, "classifier", 0, 0, 0};

ClassifierConfig small() {
  ClassifierConfig config;
  config.hidden_features = 20;
  return config;
}

double accuracy(const MlpClassifier& classifier, const RowMatrixF& x, const VectorF& classes) {
  const VectorF logits = classifier.logits(x);
  const auto num_right = ((logits.array() > 0.0f) == (classes.array() > 0.5f)).count();
  return static_cast<double>(num_right) / static_cast<double>(x.rows());
}

// Class 1 where both coordinates have the same sign: no line tells the classes apart.
TEST(MlpClassifier, LearnsABorderThatIsNoLine) {
  const RowMatrixF x = gaussian(2000, 2, 1).cast<float>();
  const VectorF classes = (x.col(0).array() * x.col(1).array() > 0.0f).cast<float>();
  MlpClassifier classifier(2, small());
  classifier.train(x.topRows(1000), classes.head(1000), kClassifierId);
  EXPECT_GT(accuracy(classifier, x.bottomRows(1000), classes.tail(1000)), 0.95);
}

// The best classifier of N(1, 1) against N(-1, 1) has the logit 2 x.
TEST(MlpClassifier, LogitsAreTheLogRatioOfDensities) {
  constexpr Index n = 4000;
  RowMatrixF x(2 * n, 1);
  x << gaussian(n, 1, 1, -1.0).cast<float>(), gaussian(n, 1, 2, 1.0).cast<float>();
  VectorF classes(2 * n);
  classes << VectorF::Zero(n), VectorF::Ones(n);
  MlpClassifier classifier(1, small());
  classifier.train(x, classes, kClassifierId);
  RowMatrixF at(5, 1);
  at << -1.0f, -0.5f, 0.0f, 0.5f, 1.0f;
  // Logistic regression would have a standard error of 0.03 for the offset and 0.06 for the slope
  // here; a network with 500 weights is allowed some four times that.
  EXPECT_LT((classifier.logits(at) - 2.0f * at.col(0)).cwiseAbs().maxCoeff(), 0.3f);
}

TEST(MlpClassifier, SameIdGivesTheSameBits) {
  const RowMatrixF x = gaussian(300, 3, 1).cast<float>();
  const VectorF classes = (x.col(0).array() > 0.0f).cast<float>();
  MlpClassifier a(3, small()), b(3, small()), c(3, small());
  a.train(x, classes, kClassifierId);
  b.train(x, classes, kClassifierId);
  c.train(x, classes, {2, "classifier", 0, 0, 0});
  EXPECT_EQ(a.logits(x), b.logits(x));
  EXPECT_NE(a.logits(x), c.logits(x));
}

TEST(MlpClassifier, RejectsShapesThatDontGoTogether) {
  EXPECT_THROW(MlpClassifier(0, small()), ShapeError);
  MlpClassifier classifier(2, small());
  EXPECT_THROW(classifier.train(RowMatrixF::Zero(4, 3), VectorF::Zero(4), kClassifierId),
               ShapeError);
  EXPECT_THROW(classifier.train(RowMatrixF::Zero(4, 2), VectorF::Zero(3), kClassifierId),
               ShapeError);
}

}  // namespace
}  // namespace npdr::inference
