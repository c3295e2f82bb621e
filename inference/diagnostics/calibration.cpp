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

CalibrationRanks rank_truths(const AmortizedPosterior& posterior_given, const RowMatrix& theta,
                             const RowMatrixF& x, Index num_samples, const StreamId& id,
                             const CalibrationHook& hook) {
  if (theta.rows() != x.rows() || num_samples < 1) {
    throw ShapeError("calibration: theta of " + std::to_string(theta.rows()) + " rows, x of " +
                     std::to_string(x.rows()) + ", " + std::to_string(num_samples) +
                     " samples, must be as many rows and at least one sample");
  }
  const Index n = theta.rows(), d = theta.cols();
  CalibrationRanks result{
      num_samples,     {n, d},   VectorX<std::int64_t>(n), VectorX<std::int64_t>(n),
      RowMatrix(n, d), Vector(n)};
  for (Index i = 0; i < n; ++i) {
    const Vector truth = theta.row(i).transpose();
    const auto given = posterior_given(x.row(i).transpose());
    const Samples drawn = given->draw(num_samples, of_simulation(id, "calibration", i));
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
    if (hook) hook(i + 1);
  }
  return result;
}

}  // namespace npdr::inference
