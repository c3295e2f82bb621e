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

// There may be room for more than are done.
bool can_go_on(const CalibrationRanks& ranks, Index n, Index dimension) {
  const Index done = ranks.num_done;
  if (done == 0) return true;
  return done > 0 && done <= n && ranks.parameter.rows() >= done && ranks.density.size() >= done &&
         ranks.distance.size() >= done && ranks.theta.rows() >= done &&
         ranks.log_prob.size() >= done && ranks.parameter.cols() == dimension &&
         ranks.theta.cols() == dimension;
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
                             const RowMatrixF& x, CalibrationRanks earlier, const StreamId& id,
                             const CalibrationHook& hook) {
  const Index n = theta.rows(), d = theta.cols();
  if (n != x.rows() || earlier.num_samples < 1 || !can_go_on(earlier, n, d)) {
    throw ShapeError("calibration: theta of " + std::to_string(n) + " rows, x of " +
                     std::to_string(x.rows()) + ", " + std::to_string(earlier.num_samples) +
                     " samples, " + std::to_string(earlier.num_done) +
                     " simulations done, must be as many rows, at least one sample, and of those "
                     "that are done the ranks, as many as there are at most");
  }
  CalibrationRanks result = std::move(earlier);
  result.resize(n, d);
  for (Index i = result.num_done; i < n; ++i) {
    const Vector truth = theta.row(i).transpose();
    const auto given = posterior_given(x.row(i).transpose());
    const Samples drawn = given->draw(result.num_samples, of_simulation(id, "calibration", i));
    const RowMatrix& samples = drawn.theta;
    const std::vector<Index> of_parameters = ranks(samples, truth);
    for (Index k = 0; k < d; ++k) {
      result.parameter(i, k) = of_parameters[static_cast<std::size_t>(k)];
    }
    const double of_truth = given->relative_log_prob(truth.transpose())(0);
    result.density(i) = density_rank(given->relative_log_prob(samples), of_truth);
    result.log_prob(i) = of_truth - (drawn.report ? drawn.report->log_normalizer : 0.0);
    Stream stream(of_simulation(id, "calibration_reference", i));
    const Vector reference = Vector::NullaryExpr(d, [&](Index) { return stream.normal(); });
    const auto to_normal = [&](const RowMatrix& rows) { return given->prior().to_normal(rows); };
    result.distance(i) = distance_rank(to_normal(samples),
                                       to_normal(truth.transpose()).row(0).transpose(), reference);
    result.theta.row(i) = samples.row(0);
    result.num_done = i + 1;
    if (hook) hook(result);
  }
  return result;
}

}  // namespace npdr::inference
