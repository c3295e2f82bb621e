#include "inference/samplers/importance_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <ranges>
#include <string>

#include "core/error.h"
#include "core/log_sum_exp.h"
#include "inference/samplers/importance_weights.h"
#include "inference/standard_normal.h"
#include "inference/weighted_moments.h"

namespace npdr::inference {
namespace {

constexpr double kPriorShare = 0.05;     // of every proposal
constexpr Index kTrainingRows = 20'000;  // at most about so many points teach a flow
constexpr Index kOldLevels = 40;         // levels that count at most, besides the first
constexpr double kMostDensities = 5e7;   // of all their points by all their proposals
constexpr Index kFlowsAtEnd = 3;         // of the last proposal
constexpr double kAboutAsHigh = 0.8;     // ratio of powers that those were fitted to
constexpr Index kFormerLevels = 10;      // last levels that teach

ImportanceProposal parts_of(const std::vector<FlowReference>& flows, double prior_share) {
  ImportanceProposal parts{{}, prior_share};
  for (const FlowReference& flow : flows) parts.flows.push_back(flow.parts());
  return parts;
}

}  // namespace

Vector ImportanceSampler::Proposal::log_density(const RowMatrix& u) const {
  std::vector<Vector> terms;
  const auto add = [&](const Vector& log_density, double share) {
    if (share > 0.0) terms.push_back(log_density.array() + std::log(share));
  };
  add(log_standard_normal<double>(u), prior_share);
  const double each =
      (1.0 - prior_share) / static_cast<double>(std::max<std::size_t>(1, flows.size()));
  for (const FlowReference& flow : flows) add(flow.log_density(u), each);
  return log_sum_exp_of_terms(terms);
}

// Strata: first the prior's rows, then those of the flows.
RowMatrix ImportanceSampler::Proposal::sample(Index n, const StreamId& id) const {
  RowMatrix u(n, dimension);
  Index done =
      flows.empty() ? n : static_cast<Index>(std::lround(prior_share * static_cast<double>(n)));
  u.topRows(done) = draw_standard_normal(done, dimension, id);
  for (std::size_t k = 0; k < flows.size(); ++k) {
    const Index end =
        k + 1 == flows.size() ? n : done + (n - done) / static_cast<Index>(flows.size() - k);
    StreamId rows = id;
    rows.row += static_cast<std::uint64_t>(done);
    u.middleRows(done, end - done) = flows[k].sample(end - done, rows);
    done = end;
  }
  return u;
}

ImportanceSampler::ImportanceSampler(const ImportanceConfig& config, Index dimension,
                                     const RowMatrix& start, const StreamId& id,
                                     ImportanceState state)
    : config_(config), dimension_(dimension), id_(id), state_(std::move(state)) {
  if (!state_.levels.empty()) {
    require_shapes();
    for (std::size_t l = 0; l < state_.levels.size(); ++l) {
      proposals_.push_back(repeats_last(l) ? proposals_.back()
                                           : restore(state_.levels[l].proposal));
      numbers_.push_back(next_number_++);
    }
    if (!state_.walkers) note_densities();
    return;
  }
  Proposal proposal{{}, 1.0, dimension};
  if (start.rows() > 0) {
    proposal.flows.emplace_back(start, Vector::Ones(start.rows()), Parameters<float>(),
                                within(id_, "refine_flow"));
    proposal.prior_share = 0.5;
  }
  state_.wanted_power = config_.likelihood_power;
  begin_level(std::move(proposal), 0.0, LevelKind::lesson);
}

void ImportanceSampler::require_proposal(const ImportanceLevel& level) const {
  const ImportanceProposal& proposal = level.proposal;
  const bool has_flows = !proposal.flows.empty();
  const auto is_of_dimension = [&](const FlowParts& flow) {
    return flow.mean.size() == dimension_;
  };
  if (!std::isfinite(level.power) || !(proposal.prior_share > 0.0 && proposal.prior_share <= 1.0) ||
      (!has_flows && proposal.prior_share < 1.0) ||
      !std::ranges::all_of(proposal.flows, is_of_dimension)) {
    throw ShapeError("importance sampling: a level whose proposal can't be");
  }
}

// Only the last level may be incomplete; while walkers climb, it is a sweep, and the one before it
// may be theirs and not yet full.
void ImportanceSampler::require_shapes() const {
  const auto require = [&](bool is_right, const std::string& what) {
    if (!is_right) throw ShapeError("importance sampling: " + what);
  };
  require(state_.num_draws >= 0 && state_.num_draws_before >= 0 && state_.num_levels >= 0,
          "a number of draws or levels below 0");
  for (std::size_t l = 0; l < state_.levels.size(); ++l) {
    const ImportanceLevel& level = state_.levels[l];
    require_proposal(level);
    require(l == 0 || level.kind == LevelKind::last || !is_last(l - 1),
            "a level after the last ones");
    const bool is_back = l + 1 == state_.levels.size(), is_sweep = level.kind == LevelKind::sweep;
    const bool is_filling = level.kind == LevelKind::walkers && state_.walkers &&
                            l + 2 == state_.levels.size() && level.u.rows() < config_.level_size;
    const Index rows = is_sweep ? num_walkers() : is_filling ? level.u.rows() : config_.level_size;
    require(level.u.cols() == dimension_ && level.u.rows() == rows,
            fmt::format("a level of {} points of {} parameters, must be {} of {}", level.u.rows(),
                        level.u.cols(), rows, dimension_));
    require(
        level.log_likelihood.size() <= rows && (is_back || level.is_complete()),
        fmt::format("a level of {} likelihoods, must be {}", level.log_likelihood.size(), rows));
    require(is_sweep == (is_back && state_.walkers), "a sweep without walkers, or the other way");
  }
  require(state_.levels.front().kind == LevelKind::lesson, "a first level that doesn't teach");
  if (!state_.walkers) return;
  const TemperedWalkers& walkers = *state_.walkers;
  require(walkers.u.rows() == num_walkers() && walkers.u.cols() == dimension_ &&
              walkers.log_likelihood.size() == num_walkers(),
          fmt::format("{} walkers, must be {}", walkers.u.rows(), num_walkers()));
  const RowMatrixX<Index>& neighbors = walkers.neighbors;
  require(neighbors.rows() == num_walkers() && neighbors.cols() >= 2,
          fmt::format("neighbors of {} walkers, must be of {}", neighbors.rows(), num_walkers()));
  require(neighbors.minCoeff() >= 0 && neighbors.maxCoeff() < num_walkers(),
          "a neighbor that isn't a walker");
}

ImportanceSampler::Proposal ImportanceSampler::restore(const ImportanceProposal& parts) const {
  Proposal proposal{{}, parts.prior_share, dimension_};
  for (const FlowParts& flow : parts.flows) proposal.flows.emplace_back(flow);
  return proposal;
}

StreamId ImportanceSampler::level_id(const char* name) const {
  StreamId id = within(id_, name);
  id.epoch = static_cast<std::uint64_t>(state_.num_levels);
  return id;
}

void ImportanceSampler::push(ImportanceLevel level, Proposal proposal) {
  state_.levels.push_back(std::move(level));
  if (!repeats_last(state_.levels.size() - 1)) {
    state_.levels.back().proposal = parts_of(proposal.flows, proposal.prior_share);
  }
  ++state_.num_levels;
  proposals_.push_back(std::move(proposal));
  numbers_.push_back(next_number_++);
}

void ImportanceSampler::begin_level(Proposal proposal, double power, LevelKind kind) {
  RowMatrix u = proposal.sample(config_.level_size, level_id("refine_draws"));
  push({.kind = kind, .proposal = {}, .power = power, .u = std::move(u), .log_likelihood = {}},
       std::move(proposal));
  note_densities();
}

void ImportanceSampler::drop(std::size_t level) {
  const auto at = static_cast<std::ptrdiff_t>(level);
  state_.levels.erase(state_.levels.begin() + at);
  proposals_.erase(proposals_.begin() + at);
  const Index number = numbers_[level];
  numbers_.erase(numbers_.begin() + at);
  std::erase_if(densities_, [&](const auto& entry) {
    return entry.first.first == number || entry.first.second == number;
  });
}

Index ImportanceSampler::num_kept_levels() const {
  const double most = std::sqrt(kMostDensities / static_cast<double>(config_.level_size));
  return std::min(kOldLevels, 2 + static_cast<Index>(most));
}

// All but the first, the walkers and the latest.
void ImportanceSampler::drop_old_levels() {
  while (std::ssize(state_.levels) > num_kept_levels()) {
    drop(state_.levels[1].kind == LevelKind::walkers ? 2 : 1);
  }
}

bool ImportanceSampler::is_done() const {
  const ImportanceLevel& last = state_.levels.back();
  if (last.kind != LevelKind::last || !last.is_complete()) return false;
  if (!has_draws_for(1)) return true;
  const ImportanceCertificate certificate = sample().certificate;
  return certificate.ess >= config_.min_ess && !has_more_to_learn(certificate);
}

RowMatrix ImportanceSampler::next(Index most) const {
  const ImportanceLevel& level = state_.levels.back();
  const Index told = level.log_likelihood.size();
  return level.u.middleRows(told, std::min(most, level.u.rows() - told));
}

void ImportanceSampler::tell(const Vector& log_likelihood) {
  ImportanceLevel& level = state_.levels.back();
  const Index told = level.log_likelihood.size();
  if (told + log_likelihood.size() > level.u.rows()) {
    throw ShapeError("importance sampling: more likelihoods than points");
  }
  level.log_likelihood.conservativeResize(told + log_likelihood.size());
  level.log_likelihood.tail(log_likelihood.size()) = log_likelihood;
  state_.num_draws += log_likelihood.size();
  if (level.is_complete() && !is_done()) plan_next_level();
}

void ImportanceSampler::settle(double power) {
  if (state_.walkers) throw Error("importance sampling: no other power while walkers climb");
  state_.wanted_power = power;
  state_.num_draws_before = 0;
  drop(state_.levels.size() - 1);
  plan_next_level();
}

Index ImportanceSampler::num_levels_of(LevelKind kind) const {
  return std::ranges::count(state_.levels, kind, &ImportanceLevel::kind);
}

// How many levels there are before the last ones.
std::size_t ImportanceSampler::num_before_last() const {
  return state_.levels.size() - static_cast<std::size_t>(num_levels_of(LevelKind::last));
}

// Last levels that are worth enough have found points that the flows didn't know, or have missed
// some that were known: weights are heavy, or a share is missed. Or as many draws as taught the
// flows aren't enough, and as many more won't be. Only where draws are left.
bool ImportanceSampler::has_more_to_learn(const ImportanceCertificate& certificate) const {
  const Index last = num_levels_of(LevelKind::last) * config_.level_size;
  if (config_.max_simulations - state_.num_draws < 2 * last) return false;
  const Index lessons = state_.num_draws - last - state_.num_draws_before;
  if (certificate.ess < config_.min_ess) {
    const double missing = static_cast<double>(last) * (config_.min_ess / certificate.ess - 1.0);
    return last >= lessons && missing > static_cast<double>(lessons);
  }
  return has_heavy_weights(certificate) || misses_known_points(certificate);
}

// The last levels teach, at most some of them: those with the heaviest points.
void ImportanceSampler::learn_from_last_levels() {
  std::vector<double> heaviest(state_.levels.size());
  std::vector<std::size_t> last;
  for (std::size_t l = 0; l < state_.levels.size(); ++l) {
    if (state_.levels[l].kind != LevelKind::last) continue;
    heaviest[l] = largest_number(log_weights(l));
    last.push_back(l);
    state_.levels[l].kind = LevelKind::former;
    state_.levels[l].proposal = parts_of(proposals_[l].flows, proposals_[l].prior_share);
  }
  std::ranges::stable_sort(last, std::greater(), [&](std::size_t l) { return heaviest[l]; });
  const Index most = std::min(kFormerLevels, num_kept_levels() / 3);
  last.erase(last.begin(), last.begin() + std::min(most, std::ssize(last)));
  std::ranges::sort(last, std::greater());
  for (const std::size_t level : last) drop(level);
  state_.num_draws_before = 0;
}

void ImportanceSampler::plan_next_level() {
  if (state_.walkers && go_on_climbing()) return;
  if (state_.levels.back().kind == LevelKind::last) {
    if (!has_more_to_learn(sample().certificate)) {
      return begin_level(proposals_.back(), state_.levels.back().power, LevelKind::last);
    }
    learn_from_last_levels();
  }
  note_densities();
  const Pool pool = this->pool(state_.levels.size());
  note_evidence(pool);
  if (!(exponentials(pool.log_weights(state_.wanted_power)).sum() > 0.0)) {
    throw InputError(
        "no simulation has a likelihood above 0: all have failed, or the noise is far too small");
  }
  if (has_learned()) return begin_last_levels();
  if (!has_enough_points(pool)) {
    drop_old_levels();
    return begin_level({{}, 1.0, dimension_}, 0.0, LevelKind::lesson);
  }
  const double power = choose_power(pool);
  if (power == state_.wanted_power && state_.num_draws_before == 0) {
    state_.num_draws_before = state_.num_draws;
  }
  if (is_worth_climbing(power)) return begin_climb(pool, power);
  const Choice lesson =
      choose_rows(truncated(pool.log_weights(power)), kTrainingRows, level_id("refine_lesson"));
  Proposal proposal{{}, kPriorShare, dimension_};
  proposal.flows.emplace_back(points(lesson.rows), lesson.weights, latest_flow(),
                              level_id("refine_flow"));
  drop_old_levels();
  begin_level(std::move(proposal), power, LevelKind::lesson);
}

// Where the training of the next flow starts; empty: from anew.
Parameters<float> ImportanceSampler::latest_flow() const {
  for (const Proposal& proposal : proposals_ | std::views::reverse) {
    if (!proposal.flows.empty()) return proposal.flows.front().parts().flow;
  }
  return {};
}

// The highest power that a flow was fitted to.
double ImportanceSampler::learned_power() const {
  double power = 0.0;
  for (const ImportanceLevel& level : state_.levels) {
    if (level.kind == LevelKind::lesson) power = std::max(power, level.power);
  }
  return std::min(power, state_.wanted_power);
}

// The latest levels whose flow was fitted to about the wanted power, or else to the highest.
std::vector<std::size_t> ImportanceSampler::best_levels() const {
  const double power = learned_power();
  std::vector<std::size_t> best;
  for (std::size_t l = state_.levels.size(); l-- > 1 && std::ssize(best) < kFlowsAtEnd;) {
    const double own = state_.levels[l].power;
    const bool is_as_high = std::min(own, power) >= kAboutAsHigh * std::max(own, power);
    const bool is_lesson = state_.levels[l].kind == LevelKind::lesson;
    if (is_as_high && is_lesson && !proposals_[l].flows.empty()) best.push_back(l);
  }
  return best;
}

// log of a level's weights by its own proposal, for the power that this was fitted to.
Vector ImportanceSampler::log_weights(std::size_t l) const {
  const ImportanceLevel& level = state_.levels[l];
  return log_standard_normal<double>(level.u) + level.power * level.log_likelihood - density(l, l);
}

// Effective share of a level's draws.
double ImportanceSampler::efficiency(std::size_t l) const {
  const Vector weights = exponentials(log_weights(l));
  if (weights.isZero(0.0)) return 0.0;
  return effective_size(weights) / static_cast<double>(weights.size());
}

bool ImportanceSampler::has_draws_for(Index num_levels) const {
  return state_.num_draws + num_levels * config_.level_size <= config_.max_simulations;
}

// Draws are left for one level alone; or those since the wanted power was reached are as many as
// the last levels are going to be, or as are left for them.
bool ImportanceSampler::has_learned() const {
  if (!has_draws_for(2)) return true;
  if (state_.num_draws_before == 0 || learned_power() != state_.wanted_power) return false;
  double sum = 0.0;
  const std::vector<std::size_t> best = best_levels();
  for (const std::size_t level : best) sum += efficiency(level);
  const double needed = config_.min_ess * static_cast<double>(best.size()) / sum;
  const auto left = static_cast<double>(config_.max_simulations - state_.num_draws);
  return static_cast<double>(state_.num_draws - state_.num_draws_before) >= std::min(needed, left);
}

void ImportanceSampler::begin_last_levels() {
  const double power = learned_power();
  const std::vector<std::size_t> best = best_levels();
  note_heavy_share(best);
  Proposal proposal{{}, best.empty() ? 1.0 : kPriorShare, dimension_};
  for (const std::size_t l : best) proposal.flows.push_back(proposals_[l].flows.front());
  begin_level(std::move(proposal), power, LevelKind::last);
}

}  // namespace npdr::inference
