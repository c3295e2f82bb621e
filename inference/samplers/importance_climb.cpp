// Transitions of ImportanceSampler by walkers, which go on where flows are stuck.
#include <algorithm>
#include <vector>

#include "inference/samplers/importance_constants.h"
#include "inference/samplers/importance_sampler.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
namespace {

// One sweep wide, the next one near.
StepKind kind_of_sweep(const TemperedWalkers& walkers) {
  return walkers.num_sweeps % 2 == 0 ? StepKind::wide : StepKind::near;
}

}  // namespace

// For walkers to walk at so many powers and at the end.
bool ImportanceSampler::has_draws_to_climb(Index num_powers) const {
  const Index draws =
      state_.num_draws + (num_powers * kSweepsOfPower + kSweepsAtEnd) * num_walkers(config_);
  return static_cast<double>(draws) <= kClimbShare * static_cast<double>(config_.max_simulations);
}

void ImportanceSampler::begin_climb(const Survey& survey) {
  const Vector logs = survey.draws.log_weights(survey.power);
  const double uniform = Stream(level_id("refine_walkers")).uniform();
  const std::vector<Index> rows =
      Resampler(truncated(logs)).systematic(num_walkers(config_), uniform);
  state_.walkers = TemperedWalkers{.u = points_of(state_.levels, config_.level_size, rows),
                                   .log_likelihood = survey.draws.log_likelihood(rows),
                                   .power = survey.power,
                                   .log_evidence = evidence(logs).log_value};
  begin_sweep();
}

void ImportanceSampler::begin_sweep() {
  TemperedWalkers& walkers = *state_.walkers;
  if (walkers.num_sweeps % kSweepsOfNeighbors == 0) choose_neighbors(walkers);
  push({.kind = LevelKind::sweep,
        .proposal = {},
        .power = walkers.power,
        .u = propose_steps(walkers, kind_of_sweep(walkers), level_id("refine_steps")),
        .log_likelihood = {}});
}

// After a sweep: another one, or lessons when the walkers have become a level.
void ImportanceSampler::go_on_climbing() {
  TemperedWalkers& walkers = *state_.walkers;
  const ImportanceLevel sweep = state_.levels.back();
  drop(state_.levels.size() - 1);
  take_steps(walkers, kind_of_sweep(walkers), sweep.u, sweep.log_likelihood,
             level_id("refine_choice"));
  if (state_.levels.back().kind == LevelKind::walkers) {
    if (walkers.num_sweeps % kSweepsOfLevel == 0) keep_walkers();
    if (state_.levels.back().u.rows() == config_.level_size) {
      state_.walkers.reset();
      return teach();
    }
  } else if (walkers.num_sweeps >= kSweepsOfPower) {
    if (walkers.power < state_.wanted_power && has_draws_to_climb(1)) {
      const Index count = walkers.u.rows();
      const double enough = kEffectiveWalkers * static_cast<double>(count);
      raise_power(walkers, next_power(walkers, state_.wanted_power, enough), count,
                  level_id("refine_walkers"));
    } else {
      walkers.num_sweeps = 0;
      push({.kind = LevelKind::walkers,
            .proposal = {},
            .power = walkers.power,
            .log_evidence = walkers.log_evidence,
            .u = RowMatrix(0, dimension_),
            .log_likelihood = {}});
    }
  }
  begin_sweep();
}

// Puts the places of the walkers into their level, which they fill in the end.
void ImportanceSampler::keep_walkers() {
  ImportanceLevel& level = state_.levels.back();
  const Index before = level.u.rows(),
              added = std::min(state_.walkers->u.rows(), config_.level_size - before);
  level.u.conservativeResize(before + added, Eigen::NoChange);
  level.u.bottomRows(added) = state_.walkers->u.topRows(added);
  level.log_likelihood.conservativeResize(before + added);
  level.log_likelihood.tail(added) = state_.walkers->log_likelihood.head(added);
}

}  // namespace npdr::inference
