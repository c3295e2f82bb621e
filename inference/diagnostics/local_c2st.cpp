#include "inference/diagnostics/local_c2st.h"

#include <algorithm>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "inference/diagnostics/mlp_classifier.h"
#include "inference/diagnostics/out_of_distribution.h"
#include "inference/diagnostics/tail_probability.h"
#include "inference/diagnostics/two_samples.h"
#include "inference/feature_transform.h"
#include "inference/matrix_features.h"

namespace npdr::inference {
namespace {

void check(const LocalC2stData& data, const LocalC2stConfig& config) {
  const Index n = data.u.rows(), d = data.u.cols();
  const bool fits = data.u_sampled.rows() == n && data.x.rows() == n &&
                    data.u_sampled.cols() == d && data.u_at_x_o.cols() == d &&
                    data.x.cols() == data.x_o.size() && data.u_at_x_o.rows() >= 1 &&
                    config.num_trials >= 1 && config.max_components >= 1 && data.x.cols() >= 1;
  if (!fits) throw ShapeError("local C2ST: parameters, samples and x don't go together");
  if (n >= kFewestSimulations) return;
  throw InputError("local C2ST: " + std::to_string(n) + " simulations, must be at least " +
                   std::to_string(kFewestSimulations));
}

// Inputs of the classifiers: standardized u and components of x.
struct Pairs {
  RowMatrixF simulated;  // (n, D + k)
  RowMatrixF sampled;    // (n, D + k)
  RowMatrixF at_x_o;     // (m, D + k)
};

Pairs make_pairs(const LocalC2stData& data, const LocalC2stConfig& config) {
  const Index components =
      std::clamp(data.x.rows() / kRowsPerComponent, Index{1}, config.max_components);
  const FeatureTransform transform = fit_feature_transform(MatrixFeatures(data.x), components);
  RowMatrixF z, z_o;
  transform.apply(data.x, z);
  transform.apply(data.x_o.transpose(), z_o);
  const RowMatrix all_u = pooled(data.u, data.u_sampled);
  const auto joined = [&](const RowMatrix& u, const RowMatrixF& x) {
    RowMatrixF rows(u.rows(), u.cols() + x.cols());
    rows << standardized(u, all_u), x;
    return rows;
  };
  return {joined(data.u, z), joined(data.u_sampled, z),
          joined(data.u_at_x_o, z_o.replicate(data.u_at_x_o.rows(), 1))};
}

// t of a classifier that learns to tell `first` from `second`.
double statistic_of(const RowMatrixF& first, const RowMatrixF& second, const RowMatrixF& at_x_o,
                    const LocalC2stConfig& config, const StreamId& id) {
  const Index n = first.rows();
  RowMatrixF x(2 * n, first.cols());
  x << first, second;
  VectorF classes(2 * n);
  classes << VectorF::Zero(n), VectorF::Ones(n);
  ClassifierConfig classifier_config;
  classifier_config.hidden_features = std::min<Index>(10 * first.cols(), 64);
  classifier_config.max_epochs = config.max_epochs;
  MlpClassifier classifier(first.cols(), classifier_config);
  classifier.train(x, classes, id);
  const Eigen::ArrayXd logits = classifier.logits(at_x_o).cast<double>().array();
  return ((1.0 + (-logits).exp()).inverse() - 0.5).square().mean();
}

double null_statistic(const Pairs& pairs, const LocalC2stConfig& config, const StreamId& id) {
  RowMatrixF first = pairs.simulated, second = pairs.sampled;
  Stream stream(id);
  for (Index i = 0; i < first.rows(); ++i) {
    if (stream.bits() % 2 == 0) first.row(i).swap(second.row(i));
  }
  return statistic_of(first, second, pairs.at_x_o, config, id);
}

}  // namespace

LocalC2st local_c2st(const LocalC2stData& data, const StreamId& id, const LocalC2stConfig& config) {
  check(data, config);
  const Pairs pairs = make_pairs(data, config);
  LocalC2st result;
  result.null.resize(config.num_trials);
  parallel_for(config.num_trials + 1, [&](Index trial) {
    StreamId of_trial = id;
    of_trial.row += static_cast<std::uint64_t>(trial);
    if (trial == 0) {
      result.statistic =
          statistic_of(pairs.simulated, pairs.sampled, pairs.at_x_o, config, of_trial);
    } else {
      result.null(trial - 1) = null_statistic(pairs, config, of_trial);
    }
  });
  result.p_value = tail_probability(result.null, result.statistic);
  return result;
}

}  // namespace npdr::inference
