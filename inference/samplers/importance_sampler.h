/// Importance sampling of a posterior whose likelihood can be computed, adaptively.
///
/// Wanted are draws of the posterior at a power a of the likelihood (1: Bayes' theorem),
///   pi(u) = N(u; 0, I) L(u)^a / Z,      Z = int N(u; 0, I) L(u)^a du,
/// over u, where the prior is N(0, I) (prior.h). Draws come in levels, each from a density q_k that
/// can be evaluated: a flow (flow_proposal.h) fitted to what the levels before have found of
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
/// The result comes from reported levels alone, which are drawn from a fixed mixture of the best
/// flows, made before any of them was drawn. So they are independent draws of a known density, and
/// Z, its standard error and the effective size mean what they say. Where they have found what the
/// flows didn't know, such as another mode, they teach further flows, and other reported levels
/// follow; so those that stay are ones that look well, and the standard error is a little too
/// small. Where even they are worth too few draws, the certificate says so, and particles() are of
/// all points.
///
/// In short (importance_sampler.cpp has the table):
///   draw a level from the prior, or half of it from the start's flow
///   until the reported levels are worth min_ess, or no draws are left:
///     after a sweep:           another sweep, until walkers have become a level
///     after a reported level:  another one, or all of them become lessons
///     after a lesson:
///       if flows have learned enough:    search for what they haven't seen, and draw around what
///                                        is found (weight_search.h), or else
///                                        begin the reported levels
///       if hardly a point is possible:   draw the prior again
///       if flows hardly raise b:         let walkers climb
///       else:                            fit a flow to all points at the largest b, and draw it
#pragma once

#include <array>
#include <vector>

#include "core/random.h"
#include "core/types.h"
#include "inference/samplers/importance_certificate.h"
#include "inference/samplers/importance_config.h"
#include "inference/samplers/importance_state.h"
#include "inference/samplers/level_densities.h"

namespace npdr::inference {

/// Weighted draws, independent unless they come from all levels.
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
  /// complete and none of all points, which are a tenth of `max_simulations` or more, or of those
  /// of the last levels, has one above 0.
  void tell(const Vector& log_likelihood);

  /// Draws of the posterior at a power up to power() from the points of all complete levels but
  /// reported ones, at most about `most` of them. Throws Error while walkers climb or a
  /// search goes on.
  ImportanceSample preliminary(double power, Index most) const;
  /// Makes `power` the one that is wanted, in place of a higher one. Only where a level has just
  /// been planned; throws Error while walkers climb or a search goes on.
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
  // Knowledge of pi by the points of all levels.
  struct Survey {
    MixtureDraws draws;
    double power;  // the largest b at which they are worth enough
  };
  // A row of the table of what follows a lesson.
  struct Transition {
    bool (ImportanceSampler::*holds)(const Survey&) const;
    void (ImportanceSampler::*begin)(const Survey&);
  };
  static const std::array<Transition, 5> kAfterLessons;

  void plan_next_level();
  void go_on_climbing();
  void go_on_reporting();
  void go_on_searching();
  void teach();

  bool should_search(const Survey& survey) const;
  void begin_search_level(const Survey& survey);
  void push_search_steps();
  bool has_learned(const Survey& survey) const;
  void begin_reported_levels(const Survey& survey);
  bool lacks_points(const Survey& survey) const;
  void draw_prior_again(const Survey& survey);
  bool is_stuck(const Survey& survey) const;
  void begin_climb(const Survey& survey);
  bool always(const Survey&) const { return true; }
  void fit_next_flow(const Survey& survey);

  Survey survey();
  double choose_power(const MixtureDraws& draws) const;
  void note_heavy_share(const std::vector<std::size_t>& levels);
  bool has_more_to_learn(const ImportanceCertificate& certificate) const;
  void learn_from_reported_levels();
  ImportanceProposal best_proposal() const;
  Vector log_weights_by(const ImportanceProposal& proposal, const RowMatrix& u,
                        const Vector& log_likelihood) const;
  Index num_searchers() const;
  std::vector<std::size_t> best_levels() const;
  Parameters<float> latest_network() const;

  bool has_draws_to_climb(Index num_powers) const;
  void begin_sweep();
  void keep_walkers();

  void push(ImportanceLevel level);
  void begin_level(ImportanceProposal proposal, double power, LevelKind kind);
  void drop(std::size_t level);
  void drop_old_levels();
  Index num_kept_levels() const;
  ImportanceSample draws_of_all(std::size_t num_levels, double power, Index most) const;
  StreamId level_id(const char* name) const;

  ImportanceConfig config_;
  Index dimension_;
  StreamId id_;
  ImportanceState state_;
  LevelDensities densities_;
};

}  // namespace npdr::inference
