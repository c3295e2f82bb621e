#include "inference/samplers/importance_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "core/log_sum_exp.h"
#include "inference/samplers/importance_constants.h"
#include "inference/standard_normal.h"

namespace npdr::inference {
namespace {

void require(bool is_right, const std::string& what) {
  if (!is_right) throw ShapeError("importance sampling: " + what);
}

void check_proposal(const ImportanceLevel& level, Index dimension) {
  const ImportanceProposal& proposal = level.proposal;
  const double share = proposal.prior_share;
  const auto fits = [&](const FlowProposal& flow) { return flow.dimension() == dimension; };
  require(std::isfinite(level.power) && share > 0.0 && share <= 1.0 &&
              (!proposal.flows.empty() || share == 1.0) &&
              std::ranges::all_of(proposal.flows, fits),
          "a level whose proposal can't be");
  for (const FlowProposal& flow : proposal.flows) flow.check();
}

void check_walkers(const TemperedWalkers& walkers, Index count, Index dimension) {
  require(walkers.u.rows() == count && walkers.u.cols() == dimension &&
              walkers.log_likelihood.size() == count,
          fmt::format("{} walkers, must be {}", walkers.u.rows(), count));
  const RowMatrixX<Index>& neighbors = walkers.neighbors;
  require(neighbors.rows() == count && neighbors.cols() >= 2,
          fmt::format("neighbors of {} walkers, must be of {}", neighbors.rows(), count));
  require(neighbors.minCoeff() >= 0 && neighbors.maxCoeff() < count,
          "a neighbor that isn't a walker");
}

void check_search(const WeightSearch& search, Index dimension) {
  const Index count = search.u.rows();
  require(search.u.cols() == dimension && search.log_likelihood.size() == count &&
              search.log_weight.size() == count && search.log_step.size() == count &&
              search.covariance.rows() == count &&
              search.covariance.cols() == dimension * dimension,
          fmt::format("a search whose parts aren't of {} searchers", count));
}

}  // namespace

Vector ImportanceProposal::log_density(const RowMatrix& u) const {
  std::vector<Vector> terms;
  const auto add = [&](const Vector& log_density, double share) {
    if (share > 0.0) terms.push_back(log_density.array() + std::log(share));
  };
  add(log_standard_normal<double>(u), prior_share);
  const double each =
      (1.0 - prior_share) / static_cast<double>(std::max<std::size_t>(1, flows.size()));
  for (const FlowProposal& flow : flows) add(flow.log_density(u), each);
  return log_sum_exp_of_terms(terms);
}

RowMatrix ImportanceProposal::sample(Index n, Index dimension, const StreamId& id) const {
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

Index ImportanceState::num_levels_of(LevelKind kind) const {
  return std::ranges::count(levels, kind, &ImportanceLevel::kind);
}

std::size_t ImportanceState::num_before_reported() const {
  return levels.size() - static_cast<std::size_t>(num_levels_of(LevelKind::reported));
}

bool ImportanceState::repeats_reported(std::size_t level) const {
  return level > 0 && levels[level].kind == LevelKind::reported &&
         levels[level - 1].kind == LevelKind::reported;
}

const ImportanceProposal& ImportanceState::proposal_of(std::size_t level) const {
  while (repeats_reported(level)) --level;
  return levels[level].proposal;
}

double ImportanceState::learned_power() const {
  double power = 0.0;
  for (const ImportanceLevel& level : levels) {
    if (level.kind == LevelKind::lesson) power = std::max(power, level.power);
  }
  return std::min(power, wanted_power);
}

Index num_walkers(const ImportanceConfig& config) {
  return (config.level_size + kSweepsOfLevel - 1) / kSweepsOfLevel;
}

// Only the last level may be incomplete; while walkers climb, it is a sweep, and the one before it
// may be theirs and not yet full.
void check_state(const ImportanceState& state, const ImportanceConfig& config, Index dimension) {
  require(state.num_draws >= 0 && state.num_draws_before >= 0 && state.num_levels >= 0,
          "a number of draws or levels below 0");
  for (std::size_t l = 0; l < state.levels.size(); ++l) {
    const ImportanceLevel& level = state.levels[l];
    check_proposal(level, dimension);
    require(l == 0 || level.kind == LevelKind::reported ||
                state.levels[l - 1].kind != LevelKind::reported,
            "a level after the last ones");
    const bool is_back = l + 1 == state.levels.size(), is_sweep = level.kind == LevelKind::sweep,
               is_search = level.kind == LevelKind::search;
    const bool is_filling = level.kind == LevelKind::walkers && state.walkers &&
                            l + 2 == state.levels.size() && level.u.rows() < config.level_size;
    const Index rows = is_sweep     ? num_walkers(config)
                       : is_search  ? (state.search ? state.search->u.rows() : 0)
                       : is_filling ? level.u.rows()
                                    : config.level_size;
    require(level.u.cols() == dimension && level.u.rows() == rows,
            fmt::format("a level of {} points of {} parameters, must be {} of {}", level.u.rows(),
                        level.u.cols(), rows, dimension));
    require(
        level.log_likelihood.size() <= rows && (is_back || level.is_complete()),
        fmt::format("a level of {} likelihoods, must be {}", level.log_likelihood.size(), rows));
    require(is_sweep == (is_back && state.walkers), "a sweep without walkers, or the other way");
    require(is_search == (is_back && state.search), "steps without a search, or the other way");
  }
  require(state.levels.front().kind == LevelKind::lesson, "a first level that doesn't teach");
  if (state.walkers) check_walkers(*state.walkers, num_walkers(config), dimension);
  if (state.search) check_search(*state.search, dimension);
}

}  // namespace npdr::inference
