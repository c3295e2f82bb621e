#include "inference/samplers/flow_proposal.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/constants.h"
#include "core/decompositions.h"
#include "core/error.h"
#include "core/log_sum_exp.h"
#include "core/matrix_blocking.h"
#include "core/parallel.h"
#include "inference/estimators/maf.h"
#include "inference/row_blocks.h"
#include "inference/samplers/importance_constants.h"
#include "inference/training/trainer.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
namespace {

constexpr EstimatorConfig kFlow = {
    .kind = EstimatorKind::nsf, .num_transforms = 5, .hidden_features = 48};
constexpr TrainingConfig kTraining = {.learning_rate = 2e-3,
                                      .batch_size = 256,
                                      .validation_fraction = 0.2,
                                      .stop_after_epochs = 10,
                                      .max_epochs = 100};
constexpr Index kFewestRows = 10;  // that a network is fitted to; two of them validate

// The network f, of a dimension; its weights are the proposal's.
struct Network {
  explicit Network(Index dimension)
      : flow(kFlow, dimension, 1, StreamId{0, "flow_structure", 0, 0, 0}, layout) {
    fix_matrix_blocking();
  }
  ParameterLayout layout;
  MaskedAutoregressiveFlow<float> flow;
};

// Maximum likelihood of weighted points, without a context.
class FlowObjective final : public Objective {
 public:
  FlowObjective(const MaskedAutoregressiveFlow<float>& flow, const RowMatrixF& points,
                const VectorF& weights)
      : flow_(flow), points_(points), weights_(weights), scratch_(flow.make_scratch()) {}

  Index num_rows() const override { return points_.rows(); }

  double loss(const Parameters<float>& parameters, const Batch& batch,
              Parameters<float>* gradient) override {
    const auto n = static_cast<Index>(batch.rows.size());
    points_of_batch_ = points_(batch.rows, Eigen::all);
    const VectorF share = weights_(batch.rows) / static_cast<float>(n);
    const RowMatrixF context = RowMatrixF::Zero(n, 1);
    flow_.log_prob(parameters, points_of_batch_, context, *scratch_, log_prob_);
    if (gradient != nullptr) {
      flow_.backward(parameters, points_of_batch_, context, -share, *scratch_, *gradient, nullptr);
    }
    return -static_cast<double>(share.dot(log_prob_));
  }

 private:
  const MaskedAutoregressiveFlow<float>& flow_;
  const RowMatrixF& points_;
  const VectorF& weights_;
  std::unique_ptr<EstimatorScratch> scratch_;
  RowMatrixF points_of_batch_;
  VectorF log_prob_;
};

// (u - m) L^-T, (n, D).
RowMatrix standardize(const FlowProposal& g, const RowMatrix& u) {
  Eigen::MatrixXd v = (u.rowwise() - g.mean.transpose()).transpose();
  g.factor.triangularView<Eigen::Lower>().solveInPlace(v);
  return v.transpose();
}

// log of the density of Student's t over v, of each row (n).
Vector log_tail(const RowMatrix& v) {
  const double nu = kTailDegrees, d = static_cast<double>(v.cols());
  const double constant = std::lgamma(0.5 * (nu + d)) - std::lgamma(0.5 * nu) -
                          0.5 * d * std::log(nu * std::numbers::pi);
  return constant - 0.5 * (nu + d) * (v.rowwise().squaredNorm() / nu).array().log1p();
}

// A draw of it.
Vector draw_tail(Index dimension, Stream& stream) {
  Vector v(dimension);
  for (double& value : v) value = stream.normal();
  double chi_squared = 0.0;
  for (int i = 0; i < kTailDegrees; ++i) chi_squared += std::pow(stream.normal(), 2);
  return v * std::sqrt(kTailDegrees / chi_squared);
}

// log(0.9 e^a + 0.1 e^b).
double log_mixture(double a, double b) {
  return log_sum_exp(Eigen::Vector2d(a + std::log1p(-kTailShare), b + std::log(kTailShare)));
}

template <class Work>
void for_each_block(Index n, const Work& work) {
  parallel_for((n + kBlockRows - 1) / kBlockRows, [&](Index block) {
    const Index first = block * kBlockRows;
    work(first, std::min(kBlockRows, n - first));
  });
}

}  // namespace

FlowProposal fit_flow(const RowMatrix& u, const Vector& weights, const Parameters<float>& start,
                      const StreamId& id) {
  FlowProposal fit{.mean = weighted_mean(u, weights), .factor = {}, .network = {}};
  const Eigen::MatrixXd covariance = regularized_covariance(u, weights);
  const Cholesky factor(covariance);
  if (!covariance.allFinite() || !factor.is_positive_definite()) {
    throw InputError("flow: the points have no covariance");
  }
  fit.factor = factor.lower();
  if (u.rows() < kFewestRows) return fit;
  const Network network(u.cols());
  TrainingState state;
  state.parameters = start;
  if (start.size() == 0) {
    state.parameters = Parameters<float>::Zero(network.layout.size());
    Stream stream(within(id, "flow_weights"));
    network.flow.initialize(state.parameters, stream);
  }
  const RowMatrixF points = standardize(fit, u).cast<float>();
  const VectorF shares = (weights / weights.mean()).cast<float>();
  FlowObjective objective(network.flow, points, shares);
  train(objective, kTraining, within(id, "flow_training"), state,
        [](const TrainingState&) { return true; });
  fit.network = state.best_parameters;
  return fit;
}

void FlowProposal::check() const {
  const Index d = dimension(), num_weights = Network(d).layout.size();
  if ((network.size() != num_weights && network.size() != 0) || factor.rows() != d ||
      factor.cols() != d) {
    throw ShapeError("flow: " + std::to_string(network.size()) + " weights for " +
                     std::to_string(d) + " parameters, must be " + std::to_string(num_weights));
  }
}

bool FlowProposal::operator==(const FlowProposal& other) const {
  return mean == other.mean && factor == other.factor && network == other.network;
}

Vector FlowProposal::log_density(const RowMatrix& u) const {
  const Network f(dimension());
  Vector result(u.rows());
  const double log_det = factor.diagonal().array().log().sum();
  for_each_block(u.rows(), [&](Index first, Index count) {
    // Always whole blocks, so that a row's bits don't depend on how many there are.
    RowMatrix rows = RowMatrix::Zero(kBlockRows, u.cols());
    rows.topRows(count) = u.middleRows(first, count);
    const RowMatrix v = standardize(*this, rows);
    const Vector tail = log_tail(v);
    if (network.size() == 0) {
      result.segment(first, count) = tail.head(count).array() - log_det;
      return;
    }
    const auto scratch = f.flow.make_scratch();
    VectorF log_prob;
    f.flow.log_prob(network, v.cast<float>(), RowMatrixF::Zero(kBlockRows, 1), *scratch, log_prob);
    for (Index i = 0; i < count; ++i) {
      const auto value = static_cast<double>(log_prob(i));
      const double flow = std::isfinite(value) ? value : -kInfinity;
      const double both = log_mixture(flow, tail(i)) - log_det;
      result(first + i) = std::isfinite(both) ? both : -kInfinity;
    }
  });
  return result;
}

RowMatrix FlowProposal::sample(Index n, const StreamId& id) const {
  const Network f(dimension());
  RowMatrix u(n, dimension());
  for_each_block(n, [&](Index first, Index count) {
    StreamId row = id;
    row.row += static_cast<std::uint64_t>(first);
    const bool has_flow = network.size() > 0;
    RowMatrix v(kBlockRows, dimension());
    if (has_flow) {
      v = f.flow.sample(network, RowMatrixF::Zero(1, 1), kBlockRows, row).cast<double>();
    }
    for (Index i = 0; i < kBlockRows; ++i) {
      StreamId own = within(id, "flow_tail");
      own.row += static_cast<std::uint64_t>(first + i);
      Stream stream(own);
      if (stream.uniform() < kTailShare || !has_flow) v.row(i) = draw_tail(dimension(), stream);
    }
    v = (v * factor.transpose()).eval();
    u.middleRows(first, count) = v.topRows(count).rowwise() + mean.transpose();
  });
  return u;
}

}  // namespace npdr::inference
