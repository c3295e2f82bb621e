#include "inference/diagnostics/calibration.h"

#include "core/error.h"
#include "inference/diagnostics/coverage.h"
#include "inference/diagnostics/sbc.h"

namespace npdr::inference {
namespace {

StreamId of_simulation(StreamId id, std::string_view name, Index i) {
  id.epoch = static_cast<std::uint64_t>(i);  // rows tell samples apart
  return named(id, name);
}

}  // namespace

void CalibrationRanks::resize(Index n, Index dimension) {
  parameter.conservativeResize(n, dimension);
  density.conservativeResize(n);
  distance.conservativeResize(n);
  theta.conservativeResize(n, dimension);
  log_prob.conservativeResize(n);
}

CalibrationRanks rank_truths(const AmortizedPosterior& posterior_given, const RowMatrix& theta,
                             const RowMatrixF& x, CalibrationRanks ranks, const StreamId& id,
                             const CalibrationHook& hook) {
  const Index n = theta.rows(), d = theta.cols();
  if (n != x.rows() || ranks.num_samples < 1 || ranks.num_done > n) {
    throw ShapeError("calibration: theta of " + std::to_string(n) + " rows, x of " +
                     std::to_string(x.rows()) + ", " + std::to_string(ranks.num_samples) +
                     " samples, " + std::to_string(ranks.num_done) +
                     " simulations done, must be as many rows, at least one sample, and no more "
                     "done than there are");
  }
  ranks.resize(n, d);
  for (Index i = ranks.num_done; i < n; ++i) {
    const Vector truth = theta.row(i).transpose();
    const auto given = posterior_given(x.row(i).transpose());
    const Samples drawn = given->draw(ranks.num_samples, of_simulation(id, "calibration", i));
    const RowMatrix& samples = drawn.theta;
    const std::vector<Index> of_parameters = inference::ranks(samples, truth);
    for (Index k = 0; k < d; ++k) {
      ranks.parameter(i, k) = of_parameters[static_cast<std::size_t>(k)];
    }
    const double of_truth = given->relative_log_prob(truth.transpose())(0);
    ranks.density(i) = density_rank(given->relative_log_prob(samples), of_truth);
    ranks.log_prob(i) = of_truth - (drawn.report ? drawn.report->log_normalizer : 0.0);
    Stream stream(of_simulation(id, "calibration_reference", i));
    const Vector reference = Vector::NullaryExpr(d, [&](Index) { return stream.normal(); });
    const auto to_normal = [&](const RowMatrix& rows) { return given->prior().to_normal(rows); };
    ranks.distance(i) = distance_rank(to_normal(samples),
                                      to_normal(truth.transpose()).row(0).transpose(), reference);
    ranks.theta.row(i) = samples.row(0);
    ranks.num_done = i + 1;
    if (hook) hook(ranks);
  }
  return ranks;
}

}  // namespace npdr::inference
