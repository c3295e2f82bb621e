#include "inference/diagnostics/c2st.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "inference/diagnostics/mlp_classifier.h"
#include "inference/diagnostics/two_samples.h"

namespace npdr::inference {
namespace {

using RowNumbers = std::vector<std::uint32_t>;

// Part `fold` of the rows in random order, and the others: the first parts have a row more where
// the rows can't be shared out evenly.
struct Fold {
  RowNumbers training;
  RowNumbers validation;
};

Fold make_fold(const RowNumbers& order, Index fold) {
  const auto n = static_cast<Index>(order.size());
  const auto begin_of = [&](Index f) {
    return order.begin() + f * (n / kC2stFolds) + std::min(f, n % kC2stFolds);
  };
  Fold result;
  result.validation.assign(begin_of(fold), begin_of(fold + 1));
  result.training.assign(order.begin(), begin_of(fold));
  result.training.insert(result.training.end(), begin_of(fold + 1), order.end());
  return result;
}

double accuracy_of(const RowMatrixF& x, const VectorF& classes, const Fold& fold,
                   const StreamId& id) {
  ClassifierConfig config;
  config.hidden_features = 10 * x.cols();
  MlpClassifier classifier(x.cols(), config);
  classifier.train(x(fold.training, Eigen::all), classes(fold.training), id);
  const VectorF logits = classifier.logits(x(fold.validation, Eigen::all));
  const VectorF expected = classes(fold.validation);
  const auto num_right = ((logits.array() > 0.0f) == (expected.array() > 0.5f)).count();
  return static_cast<double>(num_right) / static_cast<double>(expected.size());
}

}  // namespace

C2st c2st(const RowMatrix& first, const RowMatrix& second, const StreamId& id) {
  require_two_samples("C2ST", first, second);
  if (first.rows() != second.rows()) {
    throw ShapeError("C2ST: samples of " + std::to_string(first.rows()) + " and " +
                     std::to_string(second.rows()) + " rows, must be as many");
  }
  const Index n = first.rows();
  const RowMatrixF x = standardized(pooled(first, second), first);
  VectorF classes(2 * n);
  classes << VectorF::Zero(n), VectorF::Ones(n);
  const RowNumbers order = Stream(id).permutation(static_cast<std::uint32_t>(2 * n));
  C2st result;
  result.fold_accuracy.resize(kC2stFolds);
  parallel_for(kC2stFolds, [&](Index f) {
    StreamId of_fold = id;
    of_fold.row += static_cast<std::uint64_t>(f + 1);
    result.fold_accuracy(f) = accuracy_of(x, classes, make_fold(order, f), of_fold);
  });
  const double a = result.fold_accuracy.mean();
  result.accuracy = a;
  result.standard_error = std::sqrt(a * (1.0 - a) / static_cast<double>(2 * n));
  return result;
}

}  // namespace npdr::inference
