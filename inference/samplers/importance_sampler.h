/// Importance sampling of a posterior whose likelihood can be computed, adaptively.
///
/// Wanted are draws of the posterior at a power a of the likelihood (1: Bayes' theorem),
///   pi(u) = N(u; 0, I) L(u)^a / Z,      Z = int N(u; 0, I) L(u)^a du,
/// over u, where the prior is N(0, I) (prior.h). Draws come in levels, each from a density q_k that
/// can be evaluated: a flow (flow_reference.h) fitted to what the levels before have found of
///   N(u; 0, I) L(u)^b,
/// mixed with a share of the prior, so that no weight is unbounded. Points of all levels are
/// weighted as draws of the levels' mixture (Cornuet et al. 2012, "Adaptive multiple importance
/// sampling"; with flows: Williams, Veitch and Messenger 2023, "Importance nested sampling with
/// normalising flows"), and b is the largest power at which they are worth enough draws, by weights
/// that are cut off as Ionides 2008 does; it ends at a. Level 0 comes from the prior or, half of
/// it, from a flow that was fitted to the draws of another estimate of the posterior. Where flows
/// hardly raise b any more, walkers climb the rest (tempered_walkers.h); in the end they are one
/// more level, of draws of pi_b itself, as good as they are.
///
/// The result comes from last levels alone, which are drawn from a fixed mixture of the last
/// flows, made before any of them was drawn. So they are independent draws of a known density, and
/// Z, its standard error and the effective size mean what they say. Where they have found what the
/// flows didn't know, such as another mode, they teach further flows, and other last levels follow;
/// so those that stay are ones that look well, and the standard error is a little too small. Where
/// even they are worth too few draws, the certificate says so, and particles() are of all points.
#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/random.h"
#include "core/types.h"
#include "inference/samplers/flow_reference.h"
#include "inference/samplers/importance_certificate.h"
#include "inference/samplers/importance_config.h"
#include "inference/samplers/tempered_walkers.h"

namespace npdr::inference {

/// A density to draw from: flows in equal shares, and the prior.
struct ImportanceProposal {
  std::vector<FlowParts> flows;
  double prior_share = 1.0;  ///< 1 without flows
};

enum class LevelKind {
  lesson,   ///< draws that teach
  last,     ///< those that are reported
  former,   ///< those that would have been, but were found to have something to teach
  sweep,    ///< where walkers may go
  walkers,  ///< where they were, as draws of pi_b
};

/// Draws of one proposal, or of walkers.
struct ImportanceLevel {
  LevelKind kind = LevelKind::lesson;
  ImportanceProposal proposal;  ///< without flows where it is walkers', or that of the first last
  double power = 0.0;           ///< b that the proposal was fitted to, or of the walkers
  double log_evidence = 0.0;    ///< log Z_b of walkers, as far as it is known [nats]
  RowMatrix u;                  ///< (n, D)
  Vector log_likelihood;        ///< (m), of the first m <= n that have been told
  bool is_complete() const { return log_likelihood.size() == u.rows(); }
};

/// State of the sampler: a checkpoint.
struct ImportanceState {
  std::vector<ImportanceLevel> levels;     ///< the first, and those that still count
  std::optional<TemperedWalkers> walkers;  ///< while they climb
  Index num_levels = 0;                    ///< that there have been
  Index num_draws = 0;                     ///< told
  double wanted_power = 0.0;               ///< a
  Index num_draws_before = 0;              ///< told before a was reached; 0: it wasn't
  double heavy_log_weight = 0.0;  ///< of last draws: Z times sqrt(level_size), as all points tell
  double heavy_share = 0.0;       ///< of pi, at weights above that (importance_weights.h)
};

/// Weighted draws: independent ones, but for those of all points.
struct ImportanceSample {
  RowMatrix u;     ///< (n, D)
  Vector weights;  ///< (n)
  ImportanceCertificate certificate = {};
};

class ImportanceSampler {
 public:
  /// Starts anew, or goes on from a checkpoint. `start`: draws (n, D) of another estimate of the
  /// posterior; none: the prior alone. Throws ShapeError for the state of another problem.
  ImportanceSampler(const ImportanceConfig& config, Index dimension, const RowMatrix& start,
                    const StreamId& id, ImportanceState state = {});

  bool is_done() const;
  /// Whether `max_simulations` leaves draws for so many levels.
  bool has_draws_for(Index num_levels) const;
  const ImportanceState& state() const { return state_; }

  /// Up to `most` points (m, D) whose likelihood is wanted next; none when it is done.
  RowMatrix next(Index most) const;
  /// Their log L(u) [nats], (m); -infinity or NaN where it is 0. Throws InputError when a level is
  /// complete and none of all points, or of those of the last levels, has one above 0.
  void tell(const Vector& log_likelihood);

  /// Draws of the posterior at a power up to power() from the points of all complete levels but
  /// last ones, at most about `most` of them. Throws Error while walkers climb.
  ImportanceSample preliminary(double power, Index most) const;
  /// Makes `power` the one that is wanted, in place of a higher one. Only where a level has just
  /// been planned; throws Error while walkers climb.
  void settle(double power);
  /// b of the level that is drawn next.
  double power() const { return state_.levels.back().power; }
  /// a
  double wanted_power() const { return state_.wanted_power; }

  /// The point (D) of the highest L(u) so far, of those that are kept. Throws Error without any.
  Vector best_point() const;

  /// The draws of the last levels. Only when it is done.
  ImportanceSample sample() const;
  /// At most about `most` of them, which are as good to take means of: those that weigh less than
  /// others are left out at random, and weigh as much as the others where they stay. Where the last
  /// levels have less than a tenth of the effective draws that are wanted and the points before
  /// them have more, both by weights that are cut off, it is those, so that a posterior that fails
  /// isn't that of a few draws by chance.
  ImportanceSample particles(Index most) const;

 private:
  // A proposal as it is used.
  struct Proposal {
    std::vector<FlowReference> flows;
    double prior_share;
    Index dimension;
    Vector log_density(const RowMatrix& u) const;
    RowMatrix sample(Index n, const StreamId& id) const;
  };

  void require_shapes() const;
  void require_proposal(const ImportanceLevel& level) const;
  bool is_last(std::size_t level) const { return state_.levels[level].kind == LevelKind::last; }
  bool repeats_last(std::size_t level) const {
    return level > 0 && is_last(level) && is_last(level - 1);
  }
  Proposal restore(const ImportanceProposal& parts) const;
  void push(ImportanceLevel level, Proposal proposal);
  void begin_level(Proposal proposal, double power, LevelKind kind);
  void begin_last_levels();
  void plan_next_level();
  bool has_learned() const;
  bool has_more_to_learn(const ImportanceCertificate& certificate) const;
  void learn_from_last_levels();
  Index num_levels_of(LevelKind kind) const;
  std::size_t num_before_last() const;
  void note_density(std::size_t points, std::size_t proposal);
  void note_densities();
  const Vector& density(std::size_t points, std::size_t proposal) const {
    return densities_.at({numbers_[points], numbers_[proposal]});
  }
  Vector log_mixture(std::size_t level, std::size_t num_levels) const;
  bool has_proposal_of(std::size_t level, std::size_t other) const;
  void drop(std::size_t level);
  Index num_kept_levels() const;
  void drop_old_levels();
  // The points of the first levels, by their number: level after level.
  struct Pool {
    Vector log_ratio;  // log of N(u; 0, I) over the mixture of all proposals
    Vector log_likelihood;
    Vector log_weights(double power) const { return log_ratio + power * log_likelihood; }
  };

  Pool pool(std::size_t num_levels) const;
  ImportanceSample draws_of_pool(std::size_t num_levels, double power, Index most) const;
  bool has_enough_points(const Pool& pool) const;
  void note_evidence(const Pool& pool);
  Parameters<float> latest_flow() const;
  bool is_worth_climbing(double power) const;
  void begin_climb(const Pool& pool, double power);
  void begin_sweep();
  bool go_on_climbing();
  void keep_walkers();
  bool has_draws_to_climb(Index num_powers) const;
  Index num_walkers() const;
  double choose_power(const Pool& pool) const;
  RowMatrix points(const std::vector<Index>& rows) const;
  double learned_power() const;
  std::vector<std::size_t> best_levels() const;
  Vector log_weights(std::size_t level) const;
  double efficiency(std::size_t level) const;
  void note_heavy_share(const std::vector<std::size_t>& levels);
  StreamId level_id(const char* name) const;

  ImportanceConfig config_;
  Index dimension_;
  StreamId id_;
  ImportanceState state_;
  std::vector<Proposal> proposals_;  // of the state's levels
  std::vector<Index> numbers_;       // of those levels: each has its own
  Index next_number_ = 0;
  // log densities (n), by the numbers of the points' level and of the proposal's.
  std::map<std::pair<Index, Index>, Vector> densities_;
};

}  // namespace npdr::inference
