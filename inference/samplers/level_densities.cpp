#include "inference/samplers/level_densities.h"

#include <algorithm>
#include <cmath>

#include "core/log_sum_exp.h"
#include "inference/standard_normal.h"
#include "inference/weighted_population.h"

namespace npdr::inference {

// Levels that used to be reported have their proposal in common.
void LevelDensities::add(const ImportanceState& state, std::size_t l, std::size_t k) {
  const ImportanceLevel &points = state.levels[l], &proposal = state.levels[k];
  if (proposal.kind == LevelKind::walkers) return;  // they have none
  if (densities_.contains({points.number, proposal.number})) return;
  const bool is_known = k > 0 && proposal.proposal == state.levels[k - 1].proposal &&
                        densities_.contains({points.number, state.levels[k - 1].number});
  densities_[{points.number, proposal.number}] =
      is_known ? at(points, state.levels[k - 1]) : state.proposal_of(k).log_density(points.u);
}

void LevelDensities::update(const ImportanceState& state) {
  std::erase_if(densities_, [&](const auto& entry) {
    const auto is_gone = [&](Index number) {
      return !std::ranges::count(state.levels, number, &ImportanceLevel::number);
    };
    return is_gone(entry.first.first) || is_gone(entry.first.second);
  });
  for (std::size_t l = 0; l < state.levels.size(); ++l) {
    if (state.levels[l].kind == LevelKind::reported) {
      add(state, l, l);
      continue;
    }
    for (std::size_t k = 0; k < state.num_before_reported(); ++k) add(state, l, k);
  }
}

Vector LevelDensities::log_weights(const ImportanceLevel& level) const {
  return log_standard_normal<double>(level.u) + level.power * level.log_likelihood -
         at(level, level);
}

double LevelDensities::efficiency(const ImportanceLevel& level) const {
  const Vector weights = exponentials(log_weights(level));
  if (weights.isZero(0.0)) return 0.0;
  return effective_size(weights) / static_cast<double>(weights.size());
}

// log of the mixture of the first levels' densities, in equal shares, at the points of one.
Vector LevelDensities::log_mixture(const std::vector<ImportanceLevel>& levels, std::size_t l,
                                   std::size_t num_levels) const {
  std::vector<Vector> terms;
  for (std::size_t k = 0; k < num_levels; ++k) {
    const ImportanceLevel& level = levels[k];
    if (level.kind != LevelKind::walkers) {
      terms.push_back(at(levels[l], level));
      continue;
    }
    const Vector log_prior = log_standard_normal<double>(levels[l].u);
    terms.push_back(log_prior + level.power * numbers(levels[l].log_likelihood) -
                    Vector::Constant(log_prior.size(), level.log_evidence));
  }
  return log_sum_exp_of_terms(terms).array() - std::log(static_cast<double>(num_levels));
}

MixtureDraws LevelDensities::mixture_draws(const std::vector<ImportanceLevel>& levels,
                                           std::size_t num_levels) const {
  const Index each = levels.front().u.rows(), n = static_cast<Index>(num_levels) * each;
  MixtureDraws all{Vector(n), Vector(n)};
  for (std::size_t l = 0; l < num_levels; ++l) {
    const Index first = static_cast<Index>(l) * each;
    all.log_ratio.segment(first, each) =
        log_standard_normal<double>(levels[l].u) - log_mixture(levels, l, num_levels);
    all.log_likelihood.segment(first, each) = levels[l].log_likelihood;
  }
  return all;
}

Vector LevelDensities::log_ratios(const std::vector<ImportanceLevel>& levels,
                                  const std::vector<std::size_t>& proposals, double power) const {
  const Index each = levels.front().u.rows();
  Vector log_ratios(std::ssize(levels) * each);
  for (std::size_t l = 0; l < levels.size(); ++l) {
    std::vector<Vector> terms;
    for (const std::size_t k : proposals) terms.push_back(at(levels[l], levels[k]));
    log_ratios.segment(static_cast<Index>(l) * each, each) =
        log_standard_normal<double>(levels[l].u) + power * levels[l].log_likelihood -
        log_sum_exp_of_terms(terms);
  }
  return log_ratios.array() + std::log(static_cast<double>(proposals.size()));
}

RowMatrix points_of(const std::vector<ImportanceLevel>& levels, Index level_size,
                    const std::vector<Index>& rows) {
  RowMatrix u(std::ssize(rows), levels.front().u.cols());
  for (Index i = 0; i < u.rows(); ++i) {
    const Index row = rows[static_cast<std::size_t>(i)];
    u.row(i) = levels[static_cast<std::size_t>(row / level_size)].u.row(row % level_size);
  }
  return u;
}

}  // namespace npdr::inference
