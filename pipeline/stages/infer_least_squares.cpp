#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "analysis/number_text.h"
#include "analysis/summary.h"
#include "core/error.h"
#include "core/text.h"
#include "inference/least_squares/least_squares.h"
#include "pipeline/artefacts/particle_file.h"
#include "pipeline/process/progress.h"
#include "pipeline/stages/recording_errors.h"
#include "pipeline/stages/stage_parts.h"

namespace npdr::pipeline {
namespace {

constexpr Index kNumParticles = 5000;
constexpr Index kStepsInSegments = 10;  // of a start, where longer segments follow
constexpr Index kMostRounds = 5;        // with Furuta's 15 parameters two to four found better fits

// In segments first; draws of the prior are candidates in the shortest and in whole ones. At last
// from unknown first states.
inference::LeastSquaresFit find_fit(RecordingErrors& errors,
                                    const inference::LeastSquaresConfig& config,
                                    RowCounts& counts) {
  constexpr Index parts = 10;     // of the simulations, one for draws of the prior
  constexpr Index last_part = 4;  // of those that are left, one for unknown first states
  const Index count = std::max(config.num_starts, config.max_simulations / parts);
  const RowMatrix candidates = errors.prior().to_normal(inference::sample_prior(
      errors.prior(), std::min(config.num_candidates, count), errors.id("candidates")));
  const RowMatrix none(0, candidates.cols());
  RowMatrix starts = none;
  Index left = config.max_simulations;
  inference::LeastSquaresFit fit;
  const auto improve = [&](const inference::LeastSquaresProblem& problem, const RowMatrix& from,
                           const inference::LeastSquaresConfig& some, Index max_rounds) {
    const inference::LeastSquaresFit next =
        inference::least_squares(problem, from, starts, some, max_rounds, errors.id("rounds"));
    counts.failed += next.num_failed;
    counts.used += next.num_rows - next.num_failed;
    left -= next.num_rows;
    if (next.minima.empty()) return;
    starts = inference::minima_of(next);
    fit = next;
  };
  inference::LeastSquaresConfig some = config;
  const std::vector<Index> lengths = errors.segment_lengths();
  some.max_simulations = config.max_simulations / (2 * (std::ssize(lengths) + 1));
  some.max_steps = kStepsInSegments;
  for (const Index length : lengths) {
    improve(errors.in_segments(length), starts.rows() > 0 ? none : candidates, some, 0);
  }
  fit = {};
  some.max_simulations = errors.has_noisy_first_states() ? left - left / last_part : left;
  some.max_steps = config.max_steps;
  improve(errors.in_segments(0), candidates, some, kMostRounds);
  some.max_simulations = left;
  if (!fit.minima.empty() && errors.has_noisy_first_states()) {
    improve(errors.from_unknown_states(), none, some, 1);
  }
  return fit;
}

// The first answer of a run.
void tell(const Node& node, const inference::Prior& prior, const Vector& best,
          const RowMatrix& theta) {
  constexpr Index most = 8;
  std::vector<std::string> values;
  for (Index d = 0; d < std::min(most, theta.cols()); ++d) {
    const inference::Marginal& marginal = prior.marginals()[static_cast<std::size_t>(d)];
    const double deviation = analysis::summarize(theta.col(d)).std;
    const std::string unit = marginal.unit.empty() ? "" : " " + marginal.unit;
    values.push_back(marginal.name + " = " +
                     analysis::mean_std_text(best(d), deviation, analysis::NumberStyle::plain) +
                     unit);
  }
  if (theta.cols() > most) values.push_back(fmt::format("and {} more", theta.cols() - most));
  report_error(node.label(), "best fit: " + join(values));
}

}  // namespace

void infer_least_squares(const Plan& plan, const Node& node, h5::File& file) {
  const MethodConfig& method = plan.study.method(node.uses.front().method);
  RecordingErrors errors(plan, node);
  RowCounts counts;
  const inference::LeastSquaresFit fit = find_fit(errors, method.least_squares, counts);
  if (fit.minima.empty()) {
    const std::string why = errors.last_failure();
    throw FailedRolloutsError(fmt::format("{}: no draw of the prior can be simulated: {}{}",
                                          node.label(), plan.study.source().advice,
                                          why.empty() ? "" : "; for example: " + why));
  }
  if (!fit.converged) {
    report_warning(node.label(),
                   fmt::format("the fit has not converged within {} simulations; raise "
                               "max_simulations in [method.least_squares]",
                               method.least_squares.max_simulations));
  }
  const inference::Prior& prior = errors.prior();
  const RowMatrix theta = prior.to_theta(fit.sample(kNumParticles, errors.id("samples")));
  const RowMatrix best_u = fit.minima.front().u.transpose();
  const Vector best = prior.to_theta(best_u).row(0).transpose();
  const Use& use = node.uses.front();
  if (use.seed == plan.study.seeds.front() && use.fold == 0) tell(node, prior, best, theta);
  write_particles(file, name_of(method.algorithm.kind),
                  {.prior = prior,
                   .theta = theta,
                   .weights = Vector::Constant(kNumParticles, 1.0 / kNumParticles),
                   .mode = best},
                  counts);
  const Vector& own = fit.minima.front().own;
  if (own.size() > 0) write_part(file, FittedStates{errors.first_states(own)});
}

}  // namespace npdr::pipeline
