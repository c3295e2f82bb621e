/// State of adaptive importance sampling (importance_sampler.h): the levels so far.
#pragma once

#include <optional>
#include <vector>

#include "core/random.h"
#include "core/types.h"
#include "inference/samplers/flow_proposal.h"
#include "inference/samplers/importance_config.h"
#include "inference/samplers/tempered_walkers.h"
#include "inference/samplers/weight_search.h"

namespace npdr::inference {

/// A density to draw from: flows in equal shares, and the prior N(0, I).
struct ImportanceProposal {
  std::vector<FlowProposal> flows;
  double prior_share = 1.0;  ///< 1 without flows

  /// (n) [nats], of each row of u (n, D).
  Vector log_density(const RowMatrix& u) const;
  /// (n, D) draws in strata: first the prior's rows, then those of the flows.
  RowMatrix sample(Index n, Index dimension, const StreamId& id) const;

  bool operator==(const ImportanceProposal&) const = default;
};

/// Kind of a level: what its draws are for.
enum class LevelKind {
  lesson,             ///< to fit flows to
  reported,           ///< the result
  formerly_reported,  ///< a result that had something to teach, and became a lesson
  sweep,              ///< steps that walkers propose
  walkers,            ///< places of walkers, as draws of pi_b
  search,             ///< steps of a search for what the flows haven't seen
  found,              ///< draws around what it has found, which teach
};

/// Draws of one proposal, or of walkers.
struct ImportanceLevel {
  LevelKind kind = LevelKind::lesson;
  ImportanceProposal proposal;  ///< without flows where another level holds it: proposal_of()
  double power = 0.0;           ///< b that the proposal was fitted to, or of the walkers
  double log_evidence = 0.0;    ///< log Z_b of walkers, as far as it is known [nats]
  RowMatrix u;                  ///< (n, D)
  Vector log_likelihood;        ///< (m), of the first m <= n that have been told
  Index number = 0;             ///< unique among the levels of a sampler
  bool is_complete() const { return log_likelihood.size() == u.rows(); }
};

/// State of the sampler: a checkpoint.
struct ImportanceState {
  std::vector<ImportanceLevel> levels;     ///< the first, and those that still count
  std::optional<TemperedWalkers> walkers;  ///< while they climb
  std::optional<WeightSearch> search;      ///< while one goes on
  Index num_searches = 0;                  ///< begun so far
  Index num_found = 0;                     ///< places that the last of them has found
  std::optional<SearchCounts> searched;    ///< by all of them; none: no search has ended
  Index num_levels = 0;                    ///< begun so far, those that were dropped included
  Index num_draws = 0;                     ///< told
  double wanted_power = 0.0;               ///< a
  Index num_draws_before = 0;              ///< told before a was reached; 0: it wasn't
  double heavy_log_weight = 0.0;  ///< of reported draws: Z times sqrt(level_size), by all points
  double heavy_share = 0.0;       ///< of pi, at weights above that (weighted_population.h)

  Index num_levels_of(LevelKind kind) const;
  /// Number of the levels before the reported ones.
  std::size_t num_before_reported() const;
  /// Whether a level has the reported level before it, and thereby its proposal.
  bool repeats_reported(std::size_t level) const;
  const ImportanceProposal& proposal_of(std::size_t level) const;
  /// The highest power that a flow was fitted to, at most the wanted one.
  double learned_power() const;
};

/// Number of walkers, which have as many draws in ten sweeps as a level.
Index num_walkers(const ImportanceConfig& config);

/// Throws ShapeError for the state of another problem, or of none.
void check_state(const ImportanceState& state, const ImportanceConfig& config, Index dimension);

}  // namespace npdr::inference
