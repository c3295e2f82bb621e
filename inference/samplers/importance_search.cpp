// Transitions of ImportanceSampler by searches for what the flows haven't seen.
#include <algorithm>

#include "inference/samplers/importance_constants.h"
#include "inference/samplers/importance_sampler.h"
#include "inference/standard_normal.h"
#include "inference/weighted_population.h"

namespace npdr::inference {

// So many that all of their steps are a share of the draws so far.
Index ImportanceSampler::num_searchers() const {
  const auto steps = static_cast<double>(num_search_steps(dimension_));
  return static_cast<Index>(kSearchShare * static_cast<double>(state_.num_draws) / steps);
}

// Before the first reported level, and again once what the last search has found was learned, where
// draws are left for it, for what it finds and for what follows.
bool ImportanceSampler::should_search(const Survey& survey) const {
  if (!has_learned(survey) || best_levels().empty()) return false;
  const bool is_wanted =
      state_.num_searches == 0 || (state_.num_found > 0 && state_.num_searches < kMostSearches);
  const Index left = config_.max_simulations - state_.num_draws;
  const Index needed = 3 * config_.level_size + num_searchers() * num_search_steps(dimension_);
  return is_wanted && num_searchers() > 0 && needed <= left;
}

Vector ImportanceSampler::log_weights_by(const ImportanceProposal& proposal, const RowMatrix& u,
                                         const Vector& log_likelihood) const {
  return log_standard_normal<double>(u) + state_.learned_power() * log_likelihood -
         proposal.log_density(u);
}

// From the points of the first level, which are those of the prior.
void ImportanceSampler::begin_search_level(const Survey&) {
  const ImportanceLevel& first = state_.levels.front();
  ++state_.num_searches;
  state_.num_found = 0;
  state_.search =
      begin_search(first.u, first.log_likelihood,
                   log_weights_by(best_proposal(), first.u, first.log_likelihood), num_searchers());
  push_search_steps();
}

void ImportanceSampler::push_search_steps() {
  push({.kind = LevelKind::search,
        .proposal = {},
        .power = state_.learned_power(),
        .u = propose_search_steps(*state_.search, level_id("refine_search")),
        .log_likelihood = {}});
}

// After a step of all: another one, or draws around what they have found, or what follows lessons.
void ImportanceSampler::go_on_searching() {
  const ImportanceLevel steps = state_.levels.back();
  drop(state_.levels.size() - 1);
  WeightSearch& search = *state_.search;
  take_search_steps(search, steps.u, steps.log_likelihood,
                    log_weights_by(best_proposal(), steps.u, steps.log_likelihood),
                    level_id("refine_search_choice"));
  if (search.num_steps < num_search_steps(dimension_)) return push_search_steps();
  const Survey survey = this->survey();
  std::vector<FlowProposal> places =
      found_places(search, state_.learned_power(),
                   evidence(survey.draws.log_weights(state_.learned_power())).log_value);
  SearchCounts& all = state_.searched ? *state_.searched : state_.searched.emplace();
  all.num_started += search.u.rows();
  all.num_found += std::ssize(places);
  state_.search.reset();
  state_.num_found = std::ssize(places);
  if (places.empty()) return begin_reported_levels(survey);
  state_.num_draws_before = 0;
  drop_old_levels();
  begin_level({std::move(places), kPriorShare}, state_.learned_power(), LevelKind::found);
}

}  // namespace npdr::inference
