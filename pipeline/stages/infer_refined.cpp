#include <fmt/format.h>

#include <limits>
#include <optional>

#include "core/error.h"
#include "core/stop_request.h"
#include "inference/samplers/importance_sampler.h"
#include "inference/weighted_population.h"
#include "pipeline/artefacts/particle_file.h"
#include "pipeline/artefacts/refinement_file.h"
#include "pipeline/predictions/left_out.h"
#include "pipeline/process/progress.h"
#include "pipeline/stages/refined_rows.h"
#include "pipeline/stages/stage_parts.h"

namespace npdr::pipeline {
namespace {

constexpr Index kStartDraws = 5000;     // of the posterior that is refined
constexpr Index kMostParticles = 5000;  // of the refined posterior
constexpr double kSearchShare = 0.7;    // of the simulations, for finding the power
constexpr Index kMostMoves = 4;         // of first states
constexpr double kFarthest = 30.0;      // deviations that a posterior is looked for elsewhere
constexpr Index kUsualHelpers = 7;      // where the study doesn't say how many there are

using Sampler = inference::ImportanceSampler;

// Runs the sampler, with a checkpoint now and then, and one more when asked to stop.
class Refinement {
 public:
  Refinement(const Plan& plan, const Node& node, ArtefactWriter& writer)
      : plan_(plan),
        node_(node),
        prior_(plan.study.prior),
        config_(plan.study.method(node.uses.front().method).refine.sampling),
        checkpoints_(plan, node, kRefinementCheckpointSchema),
        earlier_(checkpoints_.read()),
        moves_(earlier_.moves.value_or(FirstStateMoves())),
        powers_(earlier_.powers),
        sampler_(make_sampler()),
        likelihood_(plan, node, log_of(node.path)),
        rows_(plan, node, likelihood_, {.number = 0, .count = num_helpers()}),
        progress_(node.label() + ", simulations", 0) {
    writer.add_cost(earlier_.cost);
    if (config_.cross_validate && likelihood_.num_rollouts() < 2) {
      throw InputError(node_.label() +
                       ": refine.cross_validate needs two rollouts or more; the target has one");
    }
    if (moves_.count == 0) moves_.first_errors = likelihood_.first_errors();
    likelihood_.begin_without(moves_.first_errors);
    if (earlier_.state.num_draws == 0 && moves_.count == 0) likelihood_.require_deterministic();
  }

  // Returns the number of rows that failed.
  Index run() {
    Index failed = earlier_.num_failed;
    while (!sampler_.is_done() || begin_at_likeliest()) {
      if (const std::optional<Vector> log_likelihood = simulate_next(failed)) {
        const Index level = sampler_.state().num_levels;
        sampler_.tell(*log_likelihood);
        const bool is_end = sampler_.state().num_levels != level || sampler_.is_done();
        if (is_end || level == 1) require_simulations(failed);
        if (sampler_.state().num_levels != level) {
          cross_validate();
          if (has_just_arrived()) begin_at_likeliest();
        }
        show(num_draws());
      }
      keep(failed);
    }
    return failed;
  }

  // Fills the artefact, and says what isn't right.
  void write(ArtefactWriter& writer, Index failed) const {
    writer.add_cost(rows_.cost_of_others());
    h5::File& file = writer.file();
    inference::ImportanceSample sample = sampler_.particles(kMostParticles);
    inference::ImportanceCertificate& certificate = sample.certificate;
    certificate.num_draws += moves_.num_draws;
    warn(failed, certificate.num_draws);
    write_particles(
        file, name_of(inference::Algorithm::refine),
        {.prior = prior_, .theta = prior_.to_theta(sample.u), .weights = sample.weights},
        {.used = certificate.num_draws - failed, .failed = failed});
    write_part(file, certificate);
    write_part(file, likelihood_.residuals(likeliest()));
    write_part(file, moves());
    if (config_.cross_validate) write_part(file, powers_);
  }

 private:
  Index num_helpers() const {
    const Index helpers = plan_.study.cluster.refine_tasks;
    return helpers > 0 ? helpers : kUsualHelpers;
  }

  // None: first states are exact.
  std::optional<FirstStateMoves> moves() const {
    if (!likelihood_.infers_first_states()) return std::nullopt;
    return moves_;
  }

  // "; for example: ..."; "": nothing is known of any.
  std::string words_of_failure() const {
    const std::string last = likelihood_.last_failure();
    return last.empty() ? "" : "; for example: " + last;
  }
  // All simulations so far.
  Index num_draws() const { return moves_.num_draws + sampler_.state().num_draws; }

  // theta (D) of the likeliest draw.
  Vector likeliest() const {
    const RowMatrix u = sampler_.best_point().transpose();
    return prior_.to_theta(u).row(0).transpose();
  }

  void warn(Index failed, Index num_draws) const {
    // First states were inferred to first order where that was too coarse.
    if (is_coarse_) {
      report_warning(
          node_.label(),
          fmt::format("first states are inferred to first order, which is too coarse for this "
                      "motion: {}cut shorter segments (simulator.segment_length)",
                      moves_.count < kMostMoves ? "raise refine.max_simulations, or " : ""));
    }
    if (failed == 0 || !plan_.study.source().takes_seeds) return;
    report_warning(node_.label(),
                   fmt::format("{} of {} simulations failed, and their parameters count as "
                               "impossible, which cuts the posterior where they are possible{}",
                               failed, num_draws, words_of_failure()));
  }

  // Of programs, as for other simulations (where a simulator of ours fails, parameters are
  // impossible indeed), at the end of a level, however its rows came here; in the first one as soon
  // as they are too many for all of it. What failed since the last checkpoint is simulated again by
  // who goes on from there: perhaps the fault was the machine's.
  void require_simulations(Index failed) {
    if (!plan_.study.source().takes_seeds) return;
    const Index n = std::max(num_draws(), moves_.num_draws + config_.level_size);
    const double limit = plan_.study.limits.max_failed_fraction;
    if (static_cast<double>(failed) <= limit * static_cast<double>(n)) return;
    rows_.forget(num_draws());
    throw FailedRolloutsError(fmt::format(
        "{}: {} of {} simulations failed, limits.max_failed_fraction = {} allows {} of {}; a "
        "refinement takes their parameters for impossible: {}, or raise the limit{}",
        node_.label(), failed, num_draws(), limit,
        static_cast<Index>(limit * static_cast<double>(n)), n, plan_.study.source().advice,
        words_of_failure()));
  }

  // Log likelihoods of the points that the sampler wants next: those of a block or, where there are
  // helpers, of all that it knows by now. None: a stop was requested.
  std::optional<Vector> simulate_next(Index& failed) {
    const Index first = num_draws();
    if (!rows_.has_helpers()) {
      const RowMatrix theta = prior_.to_theta(sampler_.next(block_size()));
      return likelihood_.of(likelihood_.simulate(theta, first), failed);
    }
    const RowMatrix u = sampler_.next(std::numeric_limits<Index>::max());
    std::optional<SimulatedRows> rows = rows_.ask({.first = first, .theta = prior_.to_theta(u)},
                                                  [&](Index num_rows) { show(first + num_rows); });
    if (!rows) return std::nullopt;
    failed += rows->num_failed;
    return std::move(rows->log_likelihood);
  }

  // No more at once than a program that doesn't stay is called with: between two blocks a
  // checkpoint can be written.
  Index block_size() const {
    return likelihood_.block_size(std::min(config_.level_size, plan_.study.simulate.shard_size));
  }

  // Rollouts of draws of the posterior. In the middle of planning a level there is no state to
  // save: who goes on from the last checkpoint finds what has been simulated since.
  sim::Trajectories simulate_draws(const RowMatrix& theta) {
    if (!rows_.has_helpers()) return likelihood_.simulate(theta, 0);
    std::optional<SimulatedRows> rows =
        rows_.ask({.first = 0, .rollouts = true, .theta = theta}, [](Index) {});
    if (!rows) throw Checkpointed(node_.label() + ": stopped on request, simulations are kept");
    return std::move(rows->rollouts);
  }

  void show(Index num_draws) {
    progress_.update(num_draws, fmt::format("power {:.3g}", sampler_.power()));
  }

  // When a level has been planned: scores its power, and settles on the best one at the end.
  void cross_validate() {
    if (!config_.cross_validate || is_settled() || sampler_.power() == 0.0) return;
    if (sampler_.state().levels.back().kind != inference::LevelKind::lesson) return;
    const inference::ImportanceSample draws = sampler_.preliminary(sampler_.power(), kLeftOutDraws);
    const sim::Trajectories rollouts = simulate_draws(prior_.to_theta(draws.u));
    add_power(powers_, sampler_.power(),
              likelihood_.left_out(rollouts, draws.weights, sampler_.power()));
    const bool is_late = !sampler_.has_draws_for(3) ||
                         static_cast<double>(sampler_.state().num_draws) >=
                             kSearchShare * static_cast<double>(config_.max_simulations);
    if (is_late || are_enough(powers_, config_.likelihood_power))
      sampler_.settle(best_power(powers_));
  }

  bool is_settled() const {
    return moves_.count > 0 || sampler_.wanted_power() < config_.likelihood_power ||
           are_enough(powers_, config_.likelihood_power);
  }

  // The power that is wanted has been reached, and won't change any more.
  bool has_just_arrived() const {
    const inference::ImportanceState& state = sampler_.state();
    return !state.walkers && state.num_draws_before == state.num_draws &&
           (!config_.cross_validate || is_settled());
  }

  // Where first order is too coarse around the first states that simulations begin in, they begin
  // in the likeliest ones, and the sampler anew, from draws of what it has found that are as much
  // wider as the posterior may be elsewhere. Returns whether it does: only where it may take as
  // long again.
  bool begin_at_likeliest() {
    const LikeliestFirstStates found = likelihood_.likeliest_first_states(likeliest());
    const inference::ImportanceState& state = sampler_.state();
    inference::ImportanceConfig config = config_;
    config.max_simulations -= num_draws();
    is_coarse_ = found.is_coarse();
    const bool may = moves_.count < kMostMoves && state.num_draws <= config.max_simulations;
    if (!is_coarse_ || found.errors.size() == 0 || !may) return false;
    is_coarse_ = false;
    config.likelihood_power = state.wanted_power;
    const double off = std::min(found.off, kFarthest);
    const inference::ImportanceSample wider =
        sampler_.preliminary(state.wanted_power / (1.0 + off * off), kStartDraws);
    moves_ = {found.errors, moves_.count + 1, num_draws()};
    likelihood_.begin_without(moves_.first_errors);
    const auto rows = inference::Resampler(wider.weights).systematic(kStartDraws, 0.5);
    sampler_ = {config, prior_.dimension(), wider.u(rows, Eigen::all), sampler_id()};
    return true;
  }

  StreamId sampler_id() const {
    const Use& use = node_.uses.front();
    StreamId id = {use.seed, "refinement", use.stream_round(), 0, 0};
    for (Index i = 0; i < moves_.count; ++i) id = within(id, "first_states");
    return id;
  }

  // Goes on from the checkpoint.
  Sampler make_sampler() const {
    const StreamId id = sampler_id();
    const Node* posterior = plan_.find_input(node_, numbered("posterior", 1));
    RowMatrix start;  // over u: draws of the posterior that is refined; none: the prior's
    if (earlier_.state.levels.empty() && posterior != nullptr) {
      start = prior_.to_normal(
          read_posterior(*posterior)->sample(kStartDraws, within(id, "refine_start")));
    }
    inference::ImportanceConfig config = config_;
    config.max_simulations -= moves_.num_draws;
    return {config, prior_.dimension(), start, id, earlier_.state};
  }

  void keep(Index failed) {
    const bool is_stopping = stop_requested() && !sampler_.is_done();
    if (!is_stopping && !checkpoints_.is_due()) return;
    Cost cost = earlier_.cost;
    cost += rows_.cost_of_others();
    cost.core_seconds -= rows_.unread_core_seconds();
    checkpoints_.save({sampler_.state(), moves(), failed, powers_, cost});
    rows_.forget(num_draws());
    if (is_stopping) checkpoints_.stop();
  }

  const Plan& plan_;
  const Node& node_;
  inference::Prior prior_;
  inference::ImportanceConfig config_;
  Checkpoints<RefinementCheckpoint> checkpoints_;
  RefinementCheckpoint earlier_;
  FirstStateMoves moves_;
  bool is_coarse_ = false;
  PowerScores powers_;
  Sampler sampler_;
  SimulatedLikelihood likelihood_;
  RefinedRows rows_;
  Progress progress_;
};

}  // namespace

void infer_refined(const Plan& plan, const Node& node, ArtefactWriter& writer) {
  Refinement refinement(plan, node, writer);
  const Index failed = refinement.run();
  refinement.write(writer, failed);
}

}  // namespace npdr::pipeline
