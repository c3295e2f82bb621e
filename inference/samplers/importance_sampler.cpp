#include "inference/samplers/importance_sampler.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <ranges>

#include "core/constants.h"
#include "core/error.h"
#include "inference/samplers/importance_constants.h"
#include "inference/weighted_population.h"

namespace npdr::inference {

ImportanceSampler::ImportanceSampler(const ImportanceConfig& config, Index dimension,
                                     const RowMatrix& start, const StreamId& id,
                                     ImportanceState state)
    : config_(config), dimension_(dimension), id_(id), state_(std::move(state)) {
  if (!state_.levels.empty()) {
    check_state(state_, config_, dimension_);
    Index number = state_.num_levels - std::ssize(state_.levels);
    for (ImportanceLevel& level : state_.levels) level.number = number++;
    if (!state_.walkers && !state_.search) densities_.update(state_);
    return;
  }
  ImportanceProposal proposal;
  if (start.rows() > 0) {
    proposal.flows.push_back(fit_flow(start, Vector::Ones(start.rows()), Parameters<float>(),
                                      within(id_, "refine_flow")));
    proposal.prior_share = kPriorShareOfStart;
  }
  state_.wanted_power = config_.likelihood_power;
  begin_level(std::move(proposal), 0.0, LevelKind::lesson);
}

bool ImportanceSampler::is_done() const {
  const ImportanceLevel& last = state_.levels.back();
  if (last.kind != LevelKind::reported || !last.is_complete()) return false;
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
  if (state_.walkers || state_.search) {
    throw Error("importance sampling: no other power while walkers climb or a search goes on");
  }
  state_.wanted_power = power;
  state_.num_draws_before = 0;
  drop(state_.levels.size() - 1);
  plan_next_level();
}

// Transitions after a complete level.
void ImportanceSampler::plan_next_level() {
  switch (state_.levels.back().kind) {
    case LevelKind::sweep:
      return go_on_climbing();
    case LevelKind::search:
      return go_on_searching();
    case LevelKind::reported:
      return go_on_reporting();
    default:
      return teach();
  }
}

// Transitions after a lesson: the first that holds.
const std::array<ImportanceSampler::Transition, 5> ImportanceSampler::kAfterLessons = {{
    {&ImportanceSampler::should_search, &ImportanceSampler::begin_search_level},
    {&ImportanceSampler::has_learned, &ImportanceSampler::begin_reported_levels},
    {&ImportanceSampler::lacks_points, &ImportanceSampler::draw_prior_again},
    {&ImportanceSampler::is_stuck, &ImportanceSampler::begin_climb},
    {&ImportanceSampler::always, &ImportanceSampler::fit_next_flow},
}};

void ImportanceSampler::teach() {
  const Survey survey = this->survey();
  const auto next = std::ranges::find_if(
      kAfterLessons, [&](const Transition& row) { return (this->*row.holds)(survey); });
  (this->*next->begin)(survey);
}

void ImportanceSampler::go_on_reporting() {
  if (has_more_to_learn(sample().certificate)) {
    learn_from_reported_levels();
    return teach();
  }
  begin_level(state_.proposal_of(state_.levels.size() - 1), power(), LevelKind::reported);
}

// Walkers stand for a known density but for Z, which all points tell better than the climb did,
// from one plan to the next.
ImportanceSampler::Survey ImportanceSampler::survey() {
  densities_.update(state_);
  MixtureDraws draws = densities_.mixture_draws(state_.levels, state_.levels.size());
  for (ImportanceLevel& level : state_.levels) {
    if (level.kind != LevelKind::walkers) continue;
    level.log_evidence = evidence(draws.log_weights(level.power)).log_value;
  }
  const double searched = kEmptyShare * static_cast<double>(config_.max_simulations);
  const bool is_empty = !(exponentials(draws.log_weights(state_.wanted_power)).sum() > 0.0);
  if (is_empty && static_cast<double>(state_.num_draws) >= searched) {
    throw InputError(
        "no simulation has a likelihood above 0: all have failed, or the noise is far too small");
  }
  const double power = choose_power(draws);
  return {std::move(draws), power};
}

// The largest power at which the points are worth enough.
double ImportanceSampler::choose_power(const MixtureDraws& draws) const {
  const auto possible = (draws.log_likelihood.array() > -kInfinity).count();
  const double wanted =
      kWantedShare * static_cast<double>(std::min<Index>(config_.level_size, possible));
  return largest_power(0.0, state_.wanted_power, [&](double power) {
    return effective_size(truncated(draws.log_weights(power))) >= wanted;
  });
}

// Draws are left for one level alone; or those since the wanted power was reached are as many as
// the reported levels are going to be, or as are left for them.
bool ImportanceSampler::has_learned(const Survey&) const {
  if (!has_draws_for(2)) return true;
  if (state_.num_draws_before == 0 || state_.learned_power() != state_.wanted_power) return false;
  double sum = 0.0;
  const std::vector<std::size_t> best = best_levels();
  for (const std::size_t l : best) sum += densities_.efficiency(state_.levels[l]);
  const double needed = config_.min_ess * static_cast<double>(best.size()) / sum;
  const auto left = static_cast<double>(config_.max_simulations - state_.num_draws);
  return static_cast<double>(state_.num_draws - state_.num_draws_before) >= std::min(needed, left);
}

void ImportanceSampler::begin_reported_levels(const Survey&) {
  const std::vector<std::size_t> best = best_levels();
  note_heavy_share(best);
  begin_level(best_proposal(), state_.learned_power(), LevelKind::reported);
}

// Of the reported levels.
ImportanceProposal ImportanceSampler::best_proposal() const {
  const std::vector<std::size_t> best = best_levels();
  ImportanceProposal proposal{{}, best.empty() ? 1.0 : kPriorShare};
  for (const std::size_t l : best) {
    proposal.flows.push_back(state_.levels[l].proposal.flows.front());
  }
  return proposal;
}

// Too few simulations weigh something for a flow to be fitted to them; fewer are enough where more
// levels wouldn't be kept.
bool ImportanceSampler::lacks_points(const Survey& survey) const {
  const bool is_full = std::ssize(state_.levels) >= num_kept_levels();
  const Vector weights = truncated(survey.draws.log_weights(survey.power));
  return (weights.array() > 0.0).count() < (is_full ? dimension_ + 2 : kFewestPoints);
}

void ImportanceSampler::draw_prior_again(const Survey&) {
  drop_old_levels();
  begin_level({}, 0.0, LevelKind::lesson);
}

// Ten levels have hardly raised the power. Once, and only where draws are left for the climb and
// for what follows.
bool ImportanceSampler::is_stuck(const Survey& survey) const {
  const Index n = std::ssize(state_.levels);
  const bool has_arrived = state_.num_draws_before > 0 || survey.power == state_.wanted_power;
  if (config_.cross_validate || has_arrived || n < kStuckLevels + 2) return false;
  if (state_.num_levels_of(LevelKind::walkers) > 0) return false;
  if (state_.num_levels_of(LevelKind::formerly_reported) > 0) return false;
  const double before = state_.levels[static_cast<std::size_t>(n - kStuckLevels)].power;
  return has_draws_to_climb(1 + kFewestRaises) && survey.power < kStuckRise * before;
}

void ImportanceSampler::fit_next_flow(const Survey& survey) {
  const double power = survey.power;
  if (power == state_.wanted_power && state_.num_draws_before == 0) {
    state_.num_draws_before = state_.num_draws;
  }
  const Choice lesson = choose_rows(truncated(survey.draws.log_weights(power)), kTrainingRows,
                                    level_id("refine_lesson"));
  ImportanceProposal proposal{{}, kPriorShare};
  proposal.flows.push_back(fit_flow(points_of(state_.levels, config_.level_size, lesson.rows),
                                    lesson.weights, latest_network(), level_id("refine_flow")));
  drop_old_levels();
  begin_level(std::move(proposal), power, LevelKind::lesson);
}

// Weights that the training of the next flow starts from; empty: fresh ones.
Parameters<float> ImportanceSampler::latest_network() const {
  for (const ImportanceLevel& level : state_.levels | std::views::reverse) {
    for (const FlowProposal& flow : level.proposal.flows) {
      if (flow.network.size() > 0) return flow.network;
    }
  }
  return {};
}

// The latest levels whose flow was fitted to about the wanted power, or else to the highest.
std::vector<std::size_t> ImportanceSampler::best_levels() const {
  const double power = state_.learned_power();
  std::vector<std::size_t> best;
  for (std::size_t l = state_.levels.size(); l-- > 1 && std::ssize(best) < kReportedFlows;) {
    const ImportanceLevel& level = state_.levels[l];
    const bool is_as_high =
        std::min(level.power, power) >= kAboutAsHigh * std::max(level.power, power);
    if (is_as_high && level.kind == LevelKind::lesson && !level.proposal.flows.empty()) {
      best.push_back(l);
    }
  }
  return best;
}

// Share of pi, as all points tell, that draws of the mixture q of these levels' proposals hardly
// reach: at weights w = pi / q above sqrt(n) times their mean Z, n a level's draws. A mode
// that q misses is; a point that q happens to give too little is worth no more than it weighs.
void ImportanceSampler::note_heavy_share(const std::vector<std::size_t>& levels) {
  state_.heavy_share = 0.0;
  if (levels.empty()) return;
  const double power = state_.learned_power();
  const Vector logs =
      densities_.mixture_draws(state_.levels, state_.levels.size()).log_weights(power);
  const Vector log_ratios = densities_.log_ratios(state_.levels, levels, power);
  state_.heavy_log_weight =
      evidence(logs).log_value + 0.5 * std::log(static_cast<double>(config_.level_size));
  state_.heavy_share = heavy_share(exponentials(logs), log_ratios, state_.heavy_log_weight);
}

// Reported levels that are worth enough have found points that the flows didn't know, or have
// missed some that were known: weights are heavy, or a share is missed. Or as many draws as taught
// the flows aren't enough, and as many more won't be. Only where draws are left.
bool ImportanceSampler::has_more_to_learn(const ImportanceCertificate& certificate) const {
  const Index reported = state_.num_levels_of(LevelKind::reported) * config_.level_size;
  if (config_.max_simulations - state_.num_draws < 2 * reported) return false;
  const Index lessons = state_.num_draws - reported - state_.num_draws_before;
  if (certificate.ess < config_.min_ess) {
    const double missing =
        static_cast<double>(reported) * (config_.min_ess / certificate.ess - 1.0);
    return reported >= lessons && missing > static_cast<double>(lessons);
  }
  return has_heavy_weights(certificate) || misses_known_points(certificate);
}

// At most some of them become lessons: those with the heaviest points.
void ImportanceSampler::learn_from_reported_levels() {
  const ImportanceProposal proposal = state_.proposal_of(state_.levels.size() - 1);
  std::vector<double> heaviest(state_.levels.size());
  std::vector<std::size_t> reported;
  for (std::size_t l = state_.num_before_reported(); l < state_.levels.size(); ++l) {
    heaviest[l] = largest_number(densities_.log_weights(state_.levels[l]));
    reported.push_back(l);
  }
  for (const std::size_t l : reported) {
    state_.levels[l].kind = LevelKind::formerly_reported;
    state_.levels[l].proposal = proposal;
  }
  std::ranges::stable_sort(reported, std::greater(), [&](std::size_t l) { return heaviest[l]; });
  const Index most = std::min(kMostFormerLevels, num_kept_levels() / 3);
  reported.erase(reported.begin(), reported.begin() + std::min(most, std::ssize(reported)));
  std::ranges::sort(reported, std::greater());
  for (const std::size_t level : reported) drop(level);
  state_.num_draws_before = 0;
}

void ImportanceSampler::push(ImportanceLevel level) {
  level.number = state_.num_levels++;
  state_.levels.push_back(std::move(level));
}

// The first of reported levels holds the proposal of all of them.
void ImportanceSampler::begin_level(ImportanceProposal proposal, double power, LevelKind kind) {
  RowMatrix u = proposal.sample(config_.level_size, dimension_, level_id("refine_draws"));
  push({.kind = kind,
        .proposal = std::move(proposal),
        .power = power,
        .u = std::move(u),
        .log_likelihood = {}});
  if (state_.repeats_reported(state_.levels.size() - 1)) state_.levels.back().proposal = {};
  densities_.update(state_);
}

void ImportanceSampler::drop(std::size_t level) {
  state_.levels.erase(state_.levels.begin() + static_cast<std::ptrdiff_t>(level));
}

Index ImportanceSampler::num_kept_levels() const {
  const double most = std::sqrt(kMostDensities / static_cast<double>(config_.level_size));
  return std::min(kMostOldLevels, 2 + static_cast<Index>(most));
}

// Drops all levels but the first, the walkers and the latest.
void ImportanceSampler::drop_old_levels() {
  while (std::ssize(state_.levels) > num_kept_levels()) {
    drop(state_.levels[1].kind == LevelKind::walkers ? 2 : 1);
  }
}

bool ImportanceSampler::has_draws_for(Index num_levels) const {
  return state_.num_draws + num_levels * config_.level_size <= config_.max_simulations;
}

StreamId ImportanceSampler::level_id(const char* name) const {
  StreamId id = within(id_, name);
  id.epoch = static_cast<std::uint64_t>(state_.num_levels);
  return id;
}

}  // namespace npdr::inference
