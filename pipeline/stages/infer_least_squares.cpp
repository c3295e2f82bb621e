#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "analysis/number_text.h"
#include "analysis/summary.h"
#include "core/constants.h"
#include "core/error.h"
#include "core/stop_request.h"
#include "core/text.h"
#include "inference/least_squares/least_squares.h"
#include "pipeline/artefacts/particle_file.h"
#include "pipeline/features/observation.h"
#include "pipeline/predictions/misfit.h"
#include "pipeline/process/progress.h"
#include "pipeline/stages/stage_parts.h"

namespace npdr::pipeline {
namespace {

constexpr Index kNumParticles = 5000;
constexpr Index kStepsInSegments = 10;  // of a start, where longer segments follow
constexpr Index kMostRounds = 5;        // with Furuta's 15 parameters two to four found better fits

// Errors of simulations beside what was observed, over each channel's standard deviation.
class Errors {
 public:
  Errors(const Plan& plan, const Node& node)
      : plan_(plan),
        prior_(plan.study.prior),
        observation_(plan.study, read_seen_target(plan, node)),
        log_(log_of(node.path)),
        id_{node.uses.front().seed, "least_squares", node.uses.front().stream_round(), 0, 0},
        progress_(node.label() + ", simulations", 0) {
    const Index channels = observation_.target().num_states();
    const std::vector<float>& states = observation_.states();
    const Index length = std::ssize(states) / channels;
    const RowMatrix series =
        Eigen::Map<const RowMatrixF>(states.data(), length, channels).cast<double>();
    units_ = (series.rowwise() - series.colwise().mean()).colwise().norm() /
             std::sqrt(static_cast<double>(length));
    units_ = (units_.array() > 0.0).select(units_, 1.0);
  }

  const inference::Prior& prior() const { return prior_; }
  Index num_rollouts() const { return observation_.target().num_rollouts(); }
  StreamId id(std::string_view name) const { return within(id_, name); }

  // No channel is fitted better than its sensor's noise, where that is given.
  inference::StudentErrors noise() const {
    constexpr double least = 1e-3;
    constexpr double of_deviation = 0.83;  // the scale of Student's t that Gaussian noise has
    const sim::NoiseModel& model = observation_.noise();
    const RowMatrix given = model.relative_size().cwiseProduct(model.measure());
    Vector scales = Vector::Constant(units_.size(), least);
    for (Index c = 0; c < scales.size(); ++c) {
      if (model.channels()[static_cast<std::size_t>(c)].scale.is_unknown()) continue;
      const double sigma = of_deviation * given.col(c).norm() /
                           std::sqrt(static_cast<double>(given.rows())) / units_(c);
      scales(c) = std::max(least, sigma);
    }
    return {.smallest_scales = scales};
  }

  // Deviation by what two simulations of the same parameters differ by: rounding to float, and
  // random numbers that a simulator draws.
  Vector rounding() {
    constexpr double of_float = 3.4e-8;  // deviation of uniform errors up to 2^-24
    const std::vector<float>& states = observation_.states();
    Vector squares = Vector::Zero(units_.size());
    for (Index j = 0; j < std::ssize(states); ++j) {
      const double state = states[static_cast<std::size_t>(j)];
      squares(j % units_.size()) += state * state;
    }
    const double length = static_cast<double>(states.size()) / static_cast<double>(units_.size());
    const Vector rounded =
        of_float * (squares / length).cwiseSqrt().cwiseQuotient(units_.transpose());
    if (!plan_.study.source().takes_seeds) return rounded;
    const RowMatrixF twice = of(RowMatrix::Zero(2, prior_.dimension()));
    if (!twice.allFinite()) return rounded;
    Vector differences = Vector::Zero(units_.size());
    for (Index j = 0; j < twice.cols(); ++j) {
      differences(j % units_.size()) += std::pow(twice(0, j) - twice(1, j), 2);
    }
    return rounded.cwiseMax((0.5 / length * differences).cwiseSqrt());
  }

  // [steps] of the segments that fits are made in, each twice as long as the one before; at last 0:
  // as the study replays them. Motion that forks can't be fitted at once (Bock 1983).
  std::vector<Index> segment_lengths() const {
    const sim::SimulatorConfig& simulator = plan_.study.simulator;
    const Index every = simulator.store_every, steps = observation_.target().num_steps();
    const Index part = analysis::kFitParts * every;
    const Index first = (steps + part - 1) / part * every;
    const Index longest =
        simulator.segment_length > 0 ? std::min(simulator.segment_length, steps) : steps;
    std::vector<Index> lengths;
    for (Index length = first; can_cut_rollouts(plan_) && 2 * length <= longest; length *= 2) {
      if (length >= 2 * every) lengths.push_back(length);
    }
    lengths.push_back(0);
    return lengths;
  }

  inference::ErrorsOf in_segments(Index length) {
    RowsConfig rows{plan_.study.simulator, observation_.target(), log_};
    has_own_segments_ = length > 0;
    if (has_own_segments_) rows.simulator.segment_length = length;
    simulator_ = plan_.source->open(rows);
    return [this](const RowMatrix& u) { return of(u); };
  }

  std::string last_failure() const { return simulator_->last_failure(); }

 private:
  // Rows of NaN where a program refuses segments that the study doesn't ask for.
  RowMatrixF simulate(const RowMatrix& u) {
    const RowMatrix theta = plan_.source->parameters().complete(prior_.to_theta(u));
    const Index size = std::ssize(observation_.states());
    try {
      const sim::Trajectories rows = simulator_->simulate(theta, row_after(id_, num_rows_));
      return Eigen::Map<const RowMatrixF>(rows.values.data(), u.rows(), size);
    } catch (const Checkpointed&) {
      throw;
    } catch (const Error&) {
      if (!has_own_segments_) throw;
      return RowMatrix::Constant(u.rows(), size, kNaN).cast<float>();
    }
  }

  RowMatrixF of(const RowMatrix& u) {
    stop_here_if_requested();
    RowMatrixF errors = simulate(u);
    num_rows_ += u.rows();
    progress_.update(num_rows_);
    const std::vector<float>& observed = observation_.states();
    for (Index j = 0; j < errors.cols(); ++j) {
      const auto unit = static_cast<float>(units_(j % units_.size()));
      errors.col(j) = (observed[static_cast<std::size_t>(j)] - errors.col(j).array()) / unit;
    }
    return errors;
  }

  const Plan& plan_;
  inference::Prior prior_;
  Observation observation_;
  std::filesystem::path log_;
  StreamId id_;
  Progress progress_;
  Eigen::RowVectorXd units_;  // (C)
  std::unique_ptr<RowSimulator> simulator_;
  bool has_own_segments_ = false;
  Index num_rows_ = 0;
};

// In segments first; draws of the prior are candidates in the shortest and in the last ones.
inference::LeastSquaresFit find_fit(Errors& errors, const inference::LeastSquaresConfig& config,
                                    RowCounts& counts) {
  constexpr Index parts = 10;  // of the simulations, one for draws of the prior
  const Index count = std::max(config.num_starts, config.max_simulations / parts);
  const RowMatrix candidates = errors.prior().to_normal(inference::sample_prior(
      errors.prior(), std::min(config.num_candidates, count), errors.id("candidates")));
  const std::vector<Index> lengths = errors.segment_lengths();
  RowMatrix starts(0, candidates.cols());
  inference::LeastSquaresFit fit;
  for (const Index length : lengths) {
    const bool is_last = length == lengths.back();
    inference::LeastSquaresConfig some = config;
    some.max_simulations = is_last ? config.max_simulations - counts.used - counts.failed
                                   : config.max_simulations / (2 * std::ssize(lengths));
    if (!is_last) some.max_steps = kStepsInSegments;
    const bool is_known = starts.rows() > 0 && !is_last;
    const inference::ErrorsOf of = errors.in_segments(length);
    const inference::LeastSquaresProblem problem{of, errors.num_rollouts(), errors.noise(),
                                                 errors.rounding()};
    fit = inference::least_squares(problem, is_known ? RowMatrix(0, starts.cols()) : candidates,
                                   starts, some, is_last ? kMostRounds : 0, errors.id("rounds"));
    counts.failed += fit.num_failed;
    counts.used += fit.num_rows - fit.num_failed;
    if (!fit.minima.empty()) starts = inference::minima_of(fit);
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
  Errors errors(plan, node);
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
}

}  // namespace npdr::pipeline
