#include "pipeline/stages/simulated_likelihood.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/random.h"
#include "inference/prior.h"
#include "sim/first_states.h"

namespace npdr::pipeline {
namespace {

constexpr double kSettled = 0.01;  // of a misfit, that another step may be worth
constexpr Index kMostSteps = 10;   // of Gauss and Newton
constexpr double kShortest = 0.1;  // of a step that is tried

// The first channel in which two rows differ by more than rounding does, relative to how much it
// varies; -1: none.
Index different_channel(const sim::Trajectories& rows, Index i, Index j) {
  constexpr double rounding = 1e-3;  // of chaotic motion, too
  const auto view = [&](Index row) {
    return Eigen::Map<const RowMatrixF>(rows.row(row).data(), rows.num_rollouts * rows.num_steps,
                                        rows.num_states)
        .cast<double>();
  };
  const RowMatrix one = view(i), other = view(j);
  for (Index c = 0; c < rows.num_states; ++c) {
    const double varies = (one.col(c).array() - one.col(c).mean()).matrix().norm();
    const double exact = 1e-6 * one.col(c).norm();  // of floats
    if ((one.col(c) - other.col(c)).norm() > std::max(rounding * varies, exact)) return c;
  }
  return -1;
}

sim::NoiseLikelihood likelihood_of(const RefineConfig& config, const Observation& observation) {
  const sim::NoiseModel& model = observation.noise();
  std::optional<sim::FirstStates> first_states;
  if (config.infer_first_states) first_states = sim::recorded_first_states(model);
  return {model, observation.states(), std::move(first_states)};
}

}  // namespace

SimulatedLikelihood::SimulatedLikelihood(const Plan& plan, const Node& node,
                                         const std::filesystem::path& log)
    : plan_(plan),
      log_(log),
      config_(plan.study.method(node.uses.front().method).refine),
      observation_(plan.study, read_seen_target(plan, node)),
      noise_(likelihood_of(config_, observation_)),
      id_{node.uses.front().seed, "refine_simulation", node.uses.front().stream_round(), 0, 0} {
  noise_.require_density();
  simulator_ = open(noise_, config_.sampling.level_size, log_);
}

std::unique_ptr<RowSimulator> SimulatedLikelihood::open(const sim::NoiseLikelihood& noise,
                                                        Index num_rows,
                                                        const std::filesystem::path& log) const {
  Target simulated = observation_.target();
  if (noise.infers_first_states()) {
    simulated = sim::begun_at(noise.first_states(), noise.model(), observation_.target(),
                              plan_.study.simulator.segment_length);
  }
  return plan_.source->open(
      {.simulator = plan_.study.simulator, .target = simulated, .log = log, .num_rows = num_rows});
}

RowMatrix SimulatedLikelihood::first_errors() const {
  return infers_first_states() ? noise_.first_states().errors : RowMatrix();
}

void SimulatedLikelihood::begin_without(const RowMatrix& first_errors) {
  const RowMatrix now = this->first_errors();
  if (first_errors.rows() != now.rows() || first_errors.cols() != now.cols()) {
    throw ShapeError("first states of another number of segments or channels");
  }
  if (first_errors == now) return;
  noise_.begin_without(first_errors);
  simulator_ = open(noise_, config_.sampling.level_size, log_);
}

// Steps of Gauss and Newton for given parameters: each is to the likeliest by first order, or a
// part of the way, as long as what is simulated from there fits better.
LikeliestFirstStates SimulatedLikelihood::likeliest_first_states(const Vector& theta) const {
  LikeliestFirstStates found;
  if (!infers_first_states()) return found;
  std::optional<sim::Trajectories> row = simulate_one(*simulator_, theta);
  if (!row) return found;  // it has been simulated before: perhaps the machine's fault
  sim::NoiseLikelihood noise = noise_;
  for (Index step = 0; step < kMostSteps; ++step) {
    const RowMatrix from = noise.first_states().errors;
    const sim::NoiseLikelihood::FirstStateFit fit = noise.fit_first_states(row->row(0));
    const double misfit = noise.misfit(row->row(0), fit.values);
    double gain = -1.0;
    for (double share = 1.0; share > kShortest && !(gain > 0.0); share *= 0.5) {
      noise.begin_without(from + share * (fit.errors - from));
      const auto next = simulate_one(*open(noise, 1, {}), theta);
      if (step == 0 && share == 1.0) {
        found.off = next ? noise.distance(fit.states, next->row(0), fit.values) : kInfinity;
        if (!found.is_coarse()) return found;
      }
      if (!next) continue;
      gain = misfit - noise.misfit(next->row(0), fit.values);
      if (gain > 0.0) row = next;
    }
    if (!(gain > 0.0)) break;
    found.errors = noise.first_states().errors;
    if (gain < kSettled) break;
  }
  return found;
}

Index SimulatedLikelihood::num_values() const {
  return (infers_first_states() ? 1 + observation_.target().num_states() : 1) *
         std::ssize(observation_.states());
}

std::optional<sim::Trajectories> SimulatedLikelihood::simulate_one(RowSimulator& simulator,
                                                                   const Vector& theta) const {
  StreamId id = id_;
  id.row = kNoRow;
  sim::Trajectories rows =
      simulator.simulate(plan_.source->parameters().complete(theta.transpose()), id);
  if (rows.status.front() != sim::RolloutStatus::ok) return std::nullopt;
  return rows;
}

std::optional<sim::ErrorMemory> SimulatedLikelihood::residuals(const Vector& theta) const {
  const std::optional<sim::Trajectories> row = simulate_one(*simulator_, theta);
  if (!row) return std::nullopt;
  return noise_.error_memory(row->row(0));
}

Vector SimulatedLikelihood::of(const sim::Trajectories& rows, Index& failed) const {
  Vector result(rows.num_rows);
  parallel_for(rows.num_rows, [&](Index i) { result(i) = noise_.log_likelihood(rows.row(i)); });
  failed += std::ranges::count_if(
      rows.status, [](sim::RolloutStatus status) { return status != sim::RolloutStatus::ok; });
  return result;
}

void SimulatedLikelihood::require_deterministic() const {
  if (!plan_.study.source().takes_seeds) return;
  constexpr Index count = 4, most_trials = 10;
  const inference::Prior prior(plan_.study.prior);
  Stream stream(within(id_, "deterministic"));
  RowMatrix u(2 * count, prior.dimension());
  Index num_compared = 0;
  for (Index trial = 0; trial < most_trials && num_compared < count; ++trial) {
    const Index before = num_compared;
    for (Index i = 0; i < 2 * count; i += 2) {
      for (Index d = 0; d < u.cols(); ++d) u(i, d) = u(i + 1, d) = stream.normal();
    }
    num_compared += num_equal_pairs(simulate(prior.to_theta(u), static_cast<Index>(kNoRow)));
    if (num_compared == before) return;  // all fail, perhaps for a long time each
  }
}

// Throws InputError where rows 0 and 1, 2 and 3, ... differ. Returns how many pairs could be
// compared: neither of them failed.
Index SimulatedLikelihood::num_equal_pairs(const sim::Trajectories& twice) const {
  const auto succeeded = [&](Index i) {
    return twice.status[static_cast<std::size_t>(i)] == sim::RolloutStatus::ok;
  };
  Index count = 0;
  for (Index i = 0; i < twice.num_rows; i += 2) {
    if (!succeeded(i) || !succeeded(i + 1)) continue;
    ++count;
    const Index channel = different_channel(twice, i, i + 1);
    if (channel < 0) continue;
    throw InputError(fmt::format(
        "simulated twice with the same parameters, channel '{}' differs, as of a simulator that "
        "draws random numbers or keeps something from one row to the next; a refinement needs "
        "motion that follows from theta alone: say noise of sensors in [observation_noise], not in "
        "the simulator, or choose another algorithm, such as 'npe_nle'",
        observation_.target().state_channels[static_cast<std::size_t>(channel)].label));
  }
  return count;
}

LeftOutScore SimulatedLikelihood::left_out(const sim::Trajectories& rows, const Vector& weights,
                                           double power) const {
  return left_out_score(noise_, observation_.states(), rows, weights, power,
                        within(id_, "left_out"));
}

sim::Trajectories SimulatedLikelihood::simulate(const RowMatrix& theta, Index first) const {
  StreamId id = id_;
  id.row = static_cast<std::uint64_t>(first);
  return simulator_->simulate(plan_.source->parameters().complete(theta), id);
}

}  // namespace npdr::pipeline
