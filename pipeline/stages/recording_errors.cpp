#include "pipeline/stages/recording_errors.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/error.h"
#include "core/stop_request.h"
#include "pipeline/features/first_states.h"
#include "pipeline/predictions/misfit.h"
#include "pipeline/stages/stage_parts.h"

namespace npdr::pipeline {
namespace {

// Rows from `first` on that are the same.
Index num_alike(const RowMatrix& rows, Index first) {
  Index count = 1;
  while (first + count < rows.rows() && rows.row(first + count) == rows.row(first)) ++count;
  return count;
}

}  // namespace

RecordingErrors::RecordingErrors(const Plan& plan, const Node& node)
    : plan_(plan),
      prior_(plan.study.prior),
      observation_(plan.study, read_seen_target(plan, node)),
      log_(log_of(node.path)),
      id_{node.uses.front().seed, "least_squares", node.uses.front().stream_round(), 0, 0},
      progress_(node.label() + ", simulations", 0),
      errors_of_([this](const RowMatrix& unknowns) { return of(unknowns); }),
      noise_(recorded_noise(observation_).sigma),
      segment_starts_(segment_starts(plan.study.simulator, observation_.target().num_steps())) {
  const Target& target = observation_.target();
  const std::vector<float>& states = observation_.states();
  const Index channels = target.num_states(), length = std::ssize(states) / channels;
  const RowMatrix series =
      Eigen::Map<const RowMatrixF>(states.data(), length, channels).cast<double>();
  units_ = (series.rowwise() - series.colwise().mean()).colwise().norm() /
           std::sqrt(static_cast<double>(length));
  units_ = (units_.array() > 0.0).select(units_, 1.0);
}

std::vector<Index> RecordingErrors::segment_lengths() const {
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
  return lengths;
}

inference::LeastSquaresProblem RecordingErrors::in_segments(Index length) {
  simulator_config_ = plan_.study.simulator;
  may_be_refused_ = length > 0;
  if (length > 0) simulator_config_.segment_length = length;
  open(observation_.target());
  return problem();
}

inference::LeastSquaresProblem RecordingErrors::from_unknown_states() {
  inference::LeastSquaresProblem found = in_segments(0);
  may_be_refused_ = true;
  for (const Index start : segment_starts_) {
    found.block_begins.push_back(start / simulator_config_.store_every);
  }
  return found;
}

void RecordingErrors::open(const Target& target) {
  simulator_ = plan_.source->open({simulator_config_, target, log_});
}

inference::LeastSquaresProblem RecordingErrors::problem() {
  return {errors_of_,
          observation_.target().num_rollouts(),
          {.smallest_scales = smallest_scales()},
          rounding()};
}

Vector RecordingErrors::smallest_scales() const {
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
  return scales;
}

// Deviation by what two simulations of the same parameters differ by: rounding to float, and random
// numbers that a simulator draws.
Vector RecordingErrors::rounding() {
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

RowMatrix RecordingErrors::first_states(const Vector& own) const {
  const Index channels = noise_.cols(), per_rollout = std::ssize(segment_starts_);
  RowMatrix states = first_states_of(observation_.target(), segment_starts_);
  for (Index i = 0; i < states.rows(); ++i) {
    states.row(i) -=
        own.segment(i * channels, channels).transpose().cwiseProduct(noise_.row(i / per_rollout));
  }
  return states;
}

Target RecordingErrors::begun_without(const Vector& own) const {
  return begun_in(first_states(own), segment_starts_, observation_.target());
}

// As many rows of each u as rollouts were repeated. NaN where a program refuses what the study
// doesn't ask for.
RowMatrixF RecordingErrors::simulate(const RowMatrix& u, Index rows_each) {
  const RowMatrix theta = plan_.source->parameters().complete(prior_.to_theta(u));
  const Index size = std::ssize(observation_.states()), count = u.rows() * rows_each;
  try {
    const sim::Trajectories rows = simulator_->simulate(theta, row_after(id_, num_rows_));
    return Eigen::Map<const RowMatrixF>(rows.values.data(), count, size);
  } catch (const Checkpointed&) {
    throw;
  } catch (const Error&) {
    if (!may_be_refused_) throw;
    return RowMatrix::Constant(count, size, kNaN).cast<float>();
  }
}

// Rows that begin in the same states are simulated at once, those of the same u as rollouts of one.
RowMatrixF RecordingErrors::simulate_from(const RowMatrix& u, const RowMatrix& own) {
  RowMatrixF found(u.rows(), std::ssize(observation_.states()));
  for (Index first = 0, count = 0; first < u.rows(); first += count) {
    Target target = begun_without(own.row(first));
    count = num_alike(own, first);
    if (count > 1) {
      open(target);
      found.middleRows(first, count) = simulate(u.middleRows(first, count));
      continue;
    }
    count = num_alike(u, first);
    for (Index i = 1; i < count; ++i) {
      const Target next = begun_without(own.row(first + i));
      target.rollouts.insert(target.rollouts.end(), next.rollouts.begin(), next.rollouts.end());
    }
    open(target);
    found.middleRows(first, count) = simulate(u.middleRows(first, 1), count);
  }
  return found;
}

RowMatrixF RecordingErrors::of(const RowMatrix& unknowns) {
  stop_here_if_requested();
  const Index dimension = prior_.dimension(), num_own = unknowns.cols() - dimension;
  RowMatrixF errors =
      num_own == 0 ? simulate(unknowns)
                   : simulate_from(unknowns.leftCols(dimension), unknowns.rightCols(num_own));
  num_rows_ += unknowns.rows();
  progress_.update(num_rows_);
  const std::vector<float>& observed = observation_.states();
  for (Index j = 0; j < errors.cols(); ++j) {
    const auto unit = static_cast<float>(units_(j % units_.size()));
    errors.col(j) = (observed[static_cast<std::size_t>(j)] - errors.col(j).array()) / unit;
  }
  return errors;
}

}  // namespace npdr::pipeline
