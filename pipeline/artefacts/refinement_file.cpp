#include "pipeline/artefacts/refinement_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace npdr::pipeline {
namespace {

// Older files lack it.
void describe(Layout f, std::optional<inference::SearchCounts>& searched) {
  auto group = f.group("searches", searched);
  if (!group) return;
  group->attribute("num_started", searched->num_started, "places where searchers began");
  group->attribute("num_found", searched->num_found, "places where they have found something");
}

}  // namespace

void describe(Layout f, std::optional<inference::ImportanceCertificate>& certificate) {
  auto group = f.group("certificate", certificate);
  if (!group) return;
  inference::ImportanceCertificate& c = *certificate;
  group->attribute("likelihood_power", c.power, "that was reached");
  group->attribute("wanted_power", c.wanted_power, "that was given, or chosen");
  group->attribute("num_simulations", c.num_draws, "of all levels");
  group->attribute("ess", c.ess, "effective size of the weights of the last levels");
  group->attribute("wanted_ess", c.wanted_ess, "the least that was wanted");
  group->attribute("efficiency", c.efficiency, "`ess` over the draws of the last levels");
  group->attribute("missed_share", c.missed_share,
                   "of the posterior, by points known before, where the draws' density is too low");
  group->attribute("pareto_k", c.pareto_k, "shape of the weights' tail");
  group->attribute("log_evidence", c.log_evidence, "log Z [nats]");
  group->attribute("log_evidence_error", c.log_evidence_error, "its standard error");
  group->attribute("half_difference", c.half_difference,
                   "of log Z by either half of the draws, over its standard error");
  group->attribute("pool_ess", c.ess_of_all,
                   "of the points that taught, where the particles are of those: the last levels "
                   "have too few; or 0");
  describe(*group, c.searched);
}

void describe(Layout f, std::optional<sim::ErrorMemory>& residuals) {
  auto group = f.group("residuals", residuals);
  if (!group) return;
  group->attribute("num_errors", residuals->num_errors, "of a channel");
  (*group)("memory", residuals->memory, {{"C"}}, "tau: how many errors in a row say what one does",
           kFinite);
  (*group)("size", residuals->size, {{"C"}}, "mean square of the errors, in units of the noise's",
           kFinite);
}

void describe(Layout f, std::optional<FirstStateMoves>& moves) {
  auto group = f.group("first_states", moves);
  if (!group) return;
  group->attribute("num_moves", moves->count, "of the first states that simulations begin in");
  group->attribute("num_draws", moves->num_draws, "simulated before the last of them");
  (*group)("first_errors", moves->first_errors, {{"S"}, {"C"}},
           "of the noise, over its unit, that simulations of segments begin without", kFinite);
}

void describe(Layout f, std::optional<PowerScores>& scores) {
  if (auto group = f.group("power_scores", scores)) describe(*group, *scores);
}

void describe(Layout group, PowerScores& scores) {
  group("power", scores.power, {{"k"}}, "powers of the likelihood, where they were tried",
        {.unless_empty = true});
  group("noise_factor", scores.noise_factor, {{"k"}},
        "of the noise's unknown scales, for predictions", {.unless_empty = true});
  group("crps", scores.crps, {{"k"}, {"H"}},
        "CRPS of each rollout, left out, with noise by the factor that makes it least",
        {.unless_empty = true});
  const Index k = scores.power.size();
  if (group.reads() && (scores.noise_factor.size() != k || scores.crps.rows() != k)) {
    throw InputError(fmt::format("{}: scores of {} powers, {} factors and {} rows of CRPS",
                                 group.where(), k, scores.noise_factor.size(), scores.crps.rows()));
  }
}

bool PowerScores::ends_at_least(double most) const {
  const Index k = power.size();
  return k > 0 && power(k - 1) < most && k - 1 == least();
}

Index PowerScores::least() const {
  Index least = 0;
  crps.rowwise().mean().minCoeff(&least);
  return least;
}

double PowerScores::as_good_as_any() const {
  constexpr double as_good = 0.01;  // of a score
  const double best = crps.row(least()).mean();
  return best + std::max(as_good * best, standard_error(least()));
}

double PowerScores::standard_error(Index power_number) const {
  const auto of_rollouts = crps.row(power_number).array();
  const auto count = static_cast<double>(crps.cols());
  return (of_rollouts - of_rollouts.mean()).matrix().norm() / std::sqrt(count * (count - 1.0));
}

double PowerScores::noise_factor_at(double wanted) const {
  const Index below = std::ranges::upper_bound(power, wanted) - power.begin();
  return below == 0 ? 1.0 : noise_factor(below - 1);
}

namespace {

void describe(Layout f, inference::FlowProposal& flow) {
  f("mean", flow.mean, {{"D"}}, "m", kFinite);
  f("factor", flow.factor, {{"D"}, {"D"}}, "L", kFinite);
  f("weights", flow.network, {{"P"}}, "of the network; none: Student's t alone",
    {.allowed = h5::Values::finite, .unless_empty = true});
}

void describe(Layout f, inference::ImportanceLevel& level);

// Groups name_0, name_1, ... of a list whose length is an attribute.
template <class T>
void describe_members(Layout f, const std::string& name, std::vector<T>& members) {
  Index count = std::ssize(members);
  f.attribute("num_" + name + "s", count, "how many there are");
  if (f.reads()) {
    if (count < 0 || count > 2 * inference::kMostLevels) {  // none has more flows
      throw InputError(fmt::format("{}: {} {}s; remove this file", f.where(), count, name));
    }
    members.resize(static_cast<std::size_t>(count));
  }
  if (f.lists()) members.resize(1);
  for (std::size_t i = 0; i < members.size(); ++i) {
    describe(f.group(fmt::format("{}_{}", name, i)), members[i]);
  }
}

void describe(Layout f, inference::ImportanceLevel& level) {
  Index kind = static_cast<Index>(level.kind);
  f.attribute(
      "kind", kind,
      "0: draws that teach; 1: those that are reported; 2: those that would have been; 3: where "
      "walkers may go; 4: where they were; 5: where searchers may go; 6: draws around what they "
      "have found");
  if (f.reads() && (kind < 0 || kind > static_cast<Index>(inference::LevelKind::found))) {
    throw InputError(fmt::format("{}: level of kind {}; remove this file", f.where(), kind));
  }
  level.kind = static_cast<inference::LevelKind>(kind);
  f.attribute("likelihood_power", level.power,
              "that the proposal was fitted to, or of the walkers");
  f.attribute("log_evidence", level.log_evidence, "log Z of walkers, as far as it is known [nats]");
  f.attribute("prior_share", level.proposal.prior_share, "of the proposal");
  const std::map<inference::LevelKind, const char*> others = {{inference::LevelKind::sweep, "W"},
                                                              {inference::LevelKind::walkers, "K"},
                                                              {inference::LevelKind::search, "S"}};
  const auto other = others.find(level.kind);
  f("u", level.u, {{other == others.end() ? "N" : other->second}, {"D"}},
    "points, where the prior is N(0, I); W of a sweep, K of walkers, S of searchers",
    {.allowed = h5::Values::finite, .storage = kFastest});
  Index num_told = level.log_likelihood.size();
  f.attribute("num_told", num_told, "n, of its points have been simulated");
  if (f.reads()) f.bind("n", num_told);
  f("log_likelihood", level.log_likelihood, {{"n"}}, "of the first of them [nats]",
    {.unless_empty = true, .storage = kFastest});
  describe_members(f, "flow", level.proposal.flows);
}

void describe(Layout f, inference::TemperedWalkers& w) {
  f("u", w.u, {{"W"}, {"D"}}, "where walkers are that climb", {.allowed = h5::Values::finite});
  f("log_likelihood", w.log_likelihood, {{"W"}}, "there [nats]", {.allowed = h5::Values::finite});
  f.attribute("likelihood_power", w.power, "b");
  f.attribute("log_evidence", w.log_evidence, "log Z by the climb [nats]");
  f.attribute("step_length_wide", w.step_lengths[0], "in units of the length for a Gaussian");
  f.attribute("step_length_near", w.step_lengths[1], "likewise, of steps by neighbors");
  f.attribute("num_sweeps", w.num_sweeps, "at this power");
  f("neighbors", w.neighbors, {{"W"}, {"J"}}, "of each walker, which walkers they are");
}

void describe(Layout f, inference::WeightSearch& s) {
  f("u", s.u, {{"S"}, {"D"}}, "where searchers are", kFinite);
  f("log_likelihood", s.log_likelihood, {{"S"}}, "there [nats]", kFinite);
  f("log_weight", s.log_weight, {{"S"}}, "of the posterior over the flows' density [nats]",
    kFinite);
  f("log_step", s.log_step, {{"S"}}, "logarithm of their steps' length", kFinite);
  f("covariance", s.covariance, {{"S"}, {"E"}}, "of their steps, E = D^2", kFinite);
  f.attribute("num_steps", s.num_steps, "that each has made");
}

}  // namespace

void describe(Layout f, RefinementCheckpoint& checkpoint) {
  inference::ImportanceState& state = checkpoint.state;
  f.attribute("num_failed", checkpoint.num_failed, "simulations that failed so far");
  f.attribute("num_levels_so_far", state.num_levels, "those that were dropped included");
  f.attribute("num_draws", state.num_draws, "simulated so far");
  f.attribute("wanted_power", state.wanted_power, "of the likelihood");
  f.attribute("num_draws_before", state.num_draws_before,
              "simulated before it was reached, the last time; 0: it isn't");
  f.attribute("heavy_log_weight", state.heavy_log_weight,
              "of last levels' draws: sqrt(N) times their mean, as all points tell [nats]");
  f.attribute("heavy_share", state.heavy_share, "of the posterior, at weights above that");
  f.attribute("num_searches", state.num_searches, "for what flows haven't seen");
  f.attribute("num_found", state.num_found, "places that the last of them has found");
  if (auto walkers = f.group("walkers", state.walkers)) describe(*walkers, *state.walkers);
  if (auto search = f.group("search", state.search)) describe(*search, *state.search);
  describe(f, state.searched);
  describe_members(f, "level", state.levels);
  describe(f, checkpoint.moves);
  if (!f.lists()) describe(f.group("power_scores"), checkpoint.powers);  // as in the posterior
}

void list_certificate(Layout f) {
  std::optional<inference::ImportanceCertificate> certificate;
  describe(f, certificate);
  std::optional<sim::ErrorMemory> residuals;
  describe(f, residuals);
  std::optional<FirstStateMoves> moves;
  describe(f, moves);
  std::optional<PowerScores> powers;
  describe(f, powers);
}

}  // namespace npdr::pipeline
