// Of ImportanceSampler: the points of all levels, weighted as draws of the mixture of their
// densities.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "inference/samplers/importance_sampler.h"
#include "inference/samplers/importance_weights.h"
#include "inference/standard_normal.h"
#include "inference/weighted_moments.h"

namespace npdr::inference {
namespace {

constexpr double kWantedShare = 0.2;  // effective draws that a flow is fitted to, of a level

}  // namespace

// Densities that haven't been computed yet: of all proposals at the points of all levels that
// teach, and of last levels' own, which they have in common. Walkers have none.
void ImportanceSampler::note_densities() {
  const auto teaches = [&](std::size_t level) {
    return state_.levels[level].kind != LevelKind::last;
  };
  for (std::size_t l = 0; l < state_.levels.size(); ++l) {
    for (std::size_t k = 0; k < state_.levels.size(); ++k) {
      if (state_.levels[k].kind == LevelKind::walkers) continue;
      if (densities_[l][k].size() > 0 || !(l == k || (teaches(l) && teaches(k)))) continue;
      const bool is_known = k > 0 && has_proposal_of(k, k - 1) && densities_[l][k - 1].size() > 0;
      densities_[l][k] =
          is_known ? densities_[l][k - 1] : proposals_[k].log_density(state_.levels[l].u);
    }
  }
}

// log of the mixture of the first levels' densities, in equal shares, at the points of one.
Vector ImportanceSampler::log_mixture(std::size_t l, std::size_t num_levels) const {
  const ImportanceLevel& points = state_.levels[l];
  std::vector<Vector> terms;
  for (std::size_t k = 0; k < num_levels; ++k) {
    const ImportanceLevel& level = state_.levels[k];
    if (level.kind != LevelKind::walkers) {
      terms.push_back(densities_[l][k]);
      continue;
    }
    const Vector log_prior = log_standard_normal<double>(points.u);
    terms.push_back(log_prior + level.power * numbers(points.log_likelihood) -
                    Vector::Constant(log_prior.size(), level.log_evidence));
  }
  return log_sum(terms).array() - std::log(static_cast<double>(num_levels));
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

// The largest power at which the points are worth enough.
double ImportanceSampler::choose_power(const Pool& pool) const {
  const auto possible =
      (pool.log_likelihood.array() > -std::numeric_limits<double>::infinity()).count();
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

// Effective share of draws of the mixture q of these levels' proposals, as all points foretell it:
// one in a mode that q misses has a large weight. For w = pi / q it is Z / E_pi[w], with pi and Z
// by the pool's weights. 0 without levels.
double ImportanceSampler::expected_efficiency(const std::vector<std::size_t>& levels) const {
  if (levels.empty()) return 0.0;
  const double power = learned_power(), share = 1.0 / static_cast<double>(levels.size());
  const Pool all = pool(state_.levels.size());
  const Vector logs = all.log_weights(power);
  const double largest = largest_number(logs);
  const Vector weights = truncated(logs);
  double sum = 0.0;
  for (std::size_t l = 0; l < state_.levels.size(); ++l) {
    std::vector<Vector> terms;
    for (const std::size_t k : levels) terms.push_back(densities_[l][k].array() + std::log(share));
    const Vector log_prior = log_standard_normal<double>(state_.levels[l].u),
                 log_q = log_sum(terms);
    const Index first = static_cast<Index>(l) * config_.level_size;
    for (Index i = 0; i < log_q.size(); ++i) {
      const double weight = weights(first + i);
      if (weight == 0.0) continue;
      const double log_pi = log_prior(i) + power * all.log_likelihood(first + i);
      sum += weight * std::exp(log_pi - log_q(i) - largest);
    }
  }
  return weights.mean() * weights.sum() / sum;
}

}  // namespace npdr::inference
