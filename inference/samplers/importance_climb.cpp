// Of ImportanceSampler: walkers that go on where flows are stuck.
#include <algorithm>
#include <vector>

#include "inference/samplers/importance_sampler.h"
#include "inference/samplers/importance_weights.h"
#include "inference/samplers/resampler.h"

namespace npdr::inference {
namespace {

constexpr Index kStuckLevels = 10;       // that have raised the power
constexpr double kStuckRise = 1.5;       // by less than to this multiple
constexpr Index kSweepsOfLevel = 10;     // of walkers, that have as many draws as a level
constexpr double kEffectiveShare = 0.5;  // of walkers, at the next power
constexpr Index kSweeps = 50;            // at one power
constexpr Index kSweepsOfNeighbors = 6;  // until they are chosen anew
constexpr Index kSweepsAtEnd = 100;      // of which every tenth is kept, so that they fill a level
constexpr Index kFewestRaises = 3;       // that a climb must have draws for
constexpr double kClimbShare = 0.75;     // of the simulations, until the end of the climb

// One sweep wide, the next one near.
StepKind kind_of_sweep(const TemperedWalkers& walkers) {
  return walkers.num_sweeps % 2 == 0 ? StepKind::wide : StepKind::near;
}

}  // namespace

// Whether flows are stuck: ten levels have hardly raised the power. Once, and only where draws are
// left for the climb and for what follows.
bool ImportanceSampler::is_worth_climbing(double power) const {
  const Index n = std::ssize(state_.levels);
  if (config_.cross_validate || state_.num_draws_before > 0 || n < kStuckLevels + 2) return false;
  if (num_levels_of(LevelKind::walkers) > 0 || num_levels_of(LevelKind::former) > 0) return false;
  const double before = state_.levels[static_cast<std::size_t>(n - kStuckLevels)].power;
  return has_draws_to_climb(1 + kFewestRaises) && power < kStuckRise * before;
}

// For walkers to walk at so many powers and at the end.
bool ImportanceSampler::has_draws_to_climb(Index num_powers) const {
  const Index draws = state_.num_draws + (num_powers * kSweeps + kSweepsAtEnd) * num_walkers();
  return static_cast<double>(draws) <= kClimbShare * static_cast<double>(config_.max_simulations);
}

Index ImportanceSampler::num_walkers() const {
  return (config_.level_size + kSweepsOfLevel - 1) / kSweepsOfLevel;
}

void ImportanceSampler::begin_climb(const Pool& pool, double power) {
  const Vector logs = pool.log_weights(power);
  const double uniform = Stream(level_id("refine_walkers")).uniform();
  const std::vector<Index> rows = Resampler(truncated(logs)).systematic(num_walkers(), uniform);
  state_.walkers = TemperedWalkers{.u = points(rows),
                                   .log_likelihood = pool.log_likelihood(rows),
                                   .power = power,
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
        .log_likelihood = {}},
       {{}, 1.0, dimension_});
}

// After a sweep: another one, or false when the walkers have become a level.
bool ImportanceSampler::go_on_climbing() {
  TemperedWalkers& walkers = *state_.walkers;
  const ImportanceLevel sweep = state_.levels.back();
  drop(state_.levels.size() - 1);
  take_steps(walkers, kind_of_sweep(walkers), sweep.u, sweep.log_likelihood,
             level_id("refine_choice"));
  if (state_.levels.back().kind == LevelKind::walkers) {
    if (walkers.num_sweeps % (kSweepsAtEnd / kSweepsOfLevel) == 0) keep_walkers();
    if (state_.levels.back().u.rows() == config_.level_size) {
      state_.walkers.reset();
      return false;
    }
  } else if (walkers.num_sweeps >= kSweeps) {
    if (walkers.power < state_.wanted_power && has_draws_to_climb(1)) {
      const Index count = walkers.u.rows();
      const double enough = kEffectiveShare * static_cast<double>(count);
      raise_power(walkers, next_power(walkers, state_.wanted_power, enough), count,
                  level_id("refine_walkers"));
    } else {
      walkers.num_sweeps = 0;
      push({.kind = LevelKind::walkers,
            .proposal = {},
            .power = walkers.power,
            .log_evidence = walkers.log_evidence,
            .u = RowMatrix(0, dimension_),
            .log_likelihood = {}},
           {{}, 1.0, dimension_});
    }
  }
  begin_sweep();
  return true;
}

// Puts where the walkers are into their level, which they fill in the end.
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
