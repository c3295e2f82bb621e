// Of ImportanceSampler: the points of all levels, weighted as draws of the mixture of their
// densities.
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/constants.h"
#include "core/log_sum_exp.h"
#include "inference/samplers/importance_sampler.h"
#include "inference/samplers/importance_weights.h"
#include "inference/standard_normal.h"
#include "inference/weighted_moments.h"

namespace npdr::inference {
namespace {

constexpr double kWantedShare = 0.2;  // effective draws that a flow is fitted to, of a level
constexpr Index kFewestPoints = 100, kFewestOfAll = 20;  // that a flow is fitted to

}  // namespace

// The density of one level's proposal at another's points, unless it is known. Levels that used to
// be last ones have their proposal in common.
void ImportanceSampler::note_density(std::size_t l, std::size_t k) {
  if (state_.levels[k].kind == LevelKind::walkers) return;  // they have none
  const std::pair place{numbers_[l], numbers_[k]};
  if (densities_.contains(place)) return;
  const bool is_known =
      k > 0 && has_proposal_of(k, k - 1) && densities_.contains({numbers_[l], numbers_[k - 1]});
  densities_[place] = is_known ? density(l, k - 1) : proposals_[k].log_density(state_.levels[l].u);
}

// Of all proposals at the points of all levels that teach, and of last levels' own.
void ImportanceSampler::note_densities() {
  std::vector<std::size_t> teaching;
  for (std::size_t l = 0; l < state_.levels.size(); ++l) {
    if (is_last(l)) {
      note_density(l, l);
    } else {
      teaching.push_back(l);
    }
  }
  for (const std::size_t l : teaching) {
    for (const std::size_t k : teaching) note_density(l, k);
  }
}

// log of the mixture of the first levels' densities, in equal shares, at the points of one.
Vector ImportanceSampler::log_mixture(std::size_t l, std::size_t num_levels) const {
  const ImportanceLevel& points = state_.levels[l];
  std::vector<Vector> terms;
  for (std::size_t k = 0; k < num_levels; ++k) {
    const ImportanceLevel& level = state_.levels[k];
    if (level.kind != LevelKind::walkers) {
      terms.push_back(density(l, k));
      continue;
    }
    const Vector log_prior = log_standard_normal<double>(points.u);
    terms.push_back(log_prior + level.power * numbers(points.log_likelihood) -
                    Vector::Constant(log_prior.size(), level.log_evidence));
  }
  return log_sum_exp_of_terms(terms).array() - std::log(static_cast<double>(num_levels));
}

bool ImportanceSampler::has_proposal_of(std::size_t level, std::size_t other) const {
  const ImportanceProposal &a = state_.levels[level].proposal, &b = state_.levels[other].proposal;
  const auto is_same = [](const FlowParts& one, const FlowParts& two) {
    return one.mean == two.mean && one.factor == two.factor && one.flow == two.flow;
  };
  return a.prior_share == b.prior_share && std::ranges::equal(a.flows, b.flows, is_same);
}

// Every proposal has drawn equally many, so the mixture's weights are equal.
ImportanceSampler::Pool ImportanceSampler::pool(std::size_t num_levels) const {
  const Index each = config_.level_size, n = static_cast<Index>(num_levels) * each;
  Pool pool{Vector(n), Vector(n)};
  for (std::size_t l = 0; l < num_levels; ++l) {
    const ImportanceLevel& level = state_.levels[l];
    const Index first = static_cast<Index>(l) * each;
    pool.log_ratio.segment(first, each) =
        log_standard_normal<double>(level.u) - log_mixture(l, num_levels);
    pool.log_likelihood.segment(first, each) = level.log_likelihood;
  }
  return pool;
}

// Enough simulations have a likelihood for a flow to be fitted to them; fewer are enough where more
// levels wouldn't be kept.
bool ImportanceSampler::has_enough_points(const Pool& pool) const {
  const bool is_full = std::ssize(state_.levels) >= num_kept_levels();
  return (pool.log_likelihood.array() > -kInfinity).count() >=
         (is_full ? kFewestOfAll : kFewestPoints);
}

// The largest power at which the points are worth enough.
double ImportanceSampler::choose_power(const Pool& pool) const {
  const auto possible = (pool.log_likelihood.array() > -kInfinity).count();
  const double wanted =
      kWantedShare * static_cast<double>(std::min<Index>(config_.level_size, possible));
  return largest_power(0.0, state_.wanted_power, [&](double power) {
    return effective_size(truncated(pool.log_weights(power))) >= wanted;
  });
}

// Points by their number in log_weights().
RowMatrix ImportanceSampler::points(const std::vector<Index>& rows) const {
  RowMatrix u(std::ssize(rows), dimension_);
  for (Index i = 0; i < u.rows(); ++i) {
    const Index row = rows[static_cast<std::size_t>(i)];
    const auto level = static_cast<std::size_t>(row / config_.level_size);
    u.row(i) = state_.levels[level].u.row(row % config_.level_size);
  }
  return u;
}

// What walkers stand for has a known density but for Z, which all points tell better than the
// climb did, from one plan to the next.
void ImportanceSampler::note_evidence(const Pool& pool) {
  for (ImportanceLevel& level : state_.levels) {
    if (level.kind != LevelKind::walkers) continue;
    level.log_evidence = evidence(pool.log_weights(level.power)).log_value;
  }
}

// How much of pi, as all points tell, is where draws of the mixture q of these levels' proposals
// hardly come: at weights w = pi / q above sqrt(n) times their mean Z, n a level's draws. A mode
// that q misses is; a point that q happens to give too little is worth no more than it weighs.
void ImportanceSampler::note_heavy_share(const std::vector<std::size_t>& levels) {
  state_.heavy_share = 0.0;
  if (levels.empty()) return;
  const double power = learned_power();
  const Pool all = pool(state_.levels.size());
  const Vector logs = all.log_weights(power);
  Vector log_ratios(logs.size());
  for (std::size_t l = 0; l < state_.levels.size(); ++l) {
    std::vector<Vector> terms;
    for (const std::size_t k : levels) terms.push_back(density(l, k));
    const Vector log_prior = log_standard_normal<double>(state_.levels[l].u);
    const Index first = static_cast<Index>(l) * config_.level_size, n = log_prior.size();
    log_ratios.segment(first, n) =
        log_prior + power * all.log_likelihood.segment(first, n) - log_sum_exp_of_terms(terms);
  }
  log_ratios.array() += std::log(static_cast<double>(levels.size()));
  state_.heavy_log_weight =
      evidence(logs).log_value + 0.5 * std::log(static_cast<double>(config_.level_size));
  state_.heavy_share = heavy_share(exponentials(logs), log_ratios, state_.heavy_log_weight);
}

}  // namespace npdr::inference
