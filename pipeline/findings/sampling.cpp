// How a posterior was sampled: by weights, a pool, a refinement or Markov chains.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/constants.h"
#include "core/text.h"
#include "inference/samplers/chain_diagnostics.h"
#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

// Of the weights of draws of the prior.
Finding judge_weights(const MethodResults& m) {
  constexpr double fewest = 100.0;
  const Vector sizes =
      each(m.runs, [](const EvaluatedRun* run) { return run->evaluation.sampler->ess.minCoeff(); });
  const double smallest = sizes.minCoeff();
  const Index failed = (sizes.array() < fewest).count();
  const std::string text = fmt::format("effective size {:.3g}", smallest);
  if (failed == 0) return passes(text);
  return fails("too few DIFFERENT draws" + seeds_text(failed, m.runs.size()) + ", " + text,
               fmt::format("its samples repeat draws of the prior, of which {:.3g} count: raise "
                           "sampler.num_candidates, or take sampler.kind = \"slice\"",
                           smallest));
}

// What mends the faults of a refined posterior.
std::vector<std::string> remedies_of(const MethodResults& m,
                                     const inference::ImportanceCertificate& certificate) {
  const bool is_heavy = has_heavy_weights(certificate);
  std::vector<std::string> remedies;
  if (std::ssize(faults_of(certificate)) > (is_heavy ? 1 : 0)) {
    remedies.emplace_back("raise refine.max_simulations");
  }
  if (certificate.power < certificate.wanted_power) {
    remedies.emplace_back(m.data.target.num_rollouts() > 1
                              ? "let refine.cross_validate choose a smaller power"
                              : "lower refine.likelihood_power");
  }
  if (is_heavy) remedies.emplace_back("raise refine.level_size for heavy weights");
  return remedies;
}

// Whether another seed has found what this one's draws have missed.
bool misses_a_mode(const MethodResults& m, const EvaluatedRun& run) {
  return !m.has_outer_loop() && std::ranges::any_of(m.runs, [&](const EvaluatedRun* other) {
    return finds_less(*run.notes.certificate, *other->notes.certificate);
  });
}

void add_new(std::vector<std::string>& all, const std::vector<std::string>& more) {
  for (const std::string& text : more) {
    if (std::ranges::count(all, text) == 0) all.push_back(text);
  }
}

// What a power says of the simulator, where the recording hardly counts.
std::string words_of_power(double power, bool is_chosen) {
  constexpr double small = 0.05;
  if (power >= small) return "";
  if (!is_chosen) {
    return fmt::format(
        "its draws are right, but the recording hardly counts, at refine.likelihood_power = "
        "{:.2g}: raise it, unless simulator or noise lack something",
        power);
  }
  return fmt::format(
      "its draws are right, but the recording hardly counts, at a power of {:.2g}, the smallest "
      "that predicts left-out "
      "rollouts about as well as any: simulator or noise lack something, or rollouts are too few "
      "to tell",
      power);
}

// Where all certificates hold. `power`: the smallest.
Finding pass_certificates(const MethodResults& m, const std::string& text, double power) {
  const bool is_search_cut = std::ranges::any_of(m.runs, [&](const EvaluatedRun* run) {
    return run->notes.powers.ends_at_least(m.method.refine.sampling.likelihood_power);
  });
  if (is_search_cut) {
    return passes(text,
                  "the largest power that was reached predicts rollouts that are left out best, "
                  "and larger ones may do better: raise refine.max_simulations");
  }
  const bool is_chosen = std::ranges::any_of(
      m.runs, [](const EvaluatedRun* run) { return run->notes.powers.power.size() > 0; });
  return passes(text, words_of_power(power, is_chosen));
}

// Of refined posteriors: the certificates of their draws.
Finding judge_certificates(const MethodResults& m) {
  std::vector<std::string> faults, remedies;
  Index failed = 0;
  double smallest = kInfinity, heaviest = -kInfinity, power = 1.0, largest_power = 0.0;
  bool has_pool = false;
  std::optional<inference::SearchCounts> searched;  // by all seeds
  for (const EvaluatedRun* run : m.runs) {
    const inference::ImportanceCertificate& certificate = *run->notes.certificate;
    const std::vector<std::string> its = faults_of(m, *run);
    add_new(remedies, remedies_of(m, certificate));
    if (its.size() > faults_of(certificate).size()) {
      add_new(remedies, {"raise refine.level_size for modes"});
    }
    if (const auto& its_search = certificate.searched) {
      inference::SearchCounts& all = searched ? *searched : searched.emplace();
      all.num_started += its_search->num_started;
      all.num_found += its_search->num_found;
    }
    failed += its.empty() ? 0 : 1;
    add_new(faults, its);
    smallest = std::min(smallest, certificate.ess);
    heaviest = std::max(heaviest, certificate.pareto_k);
    power = std::min(power, certificate.power);
    largest_power = std::max(largest_power, certificate.power);
    has_pool |= certificate.ess_of_all > 0.0;
  }
  std::string text = fmt::format("effective size {:.0f}, Pareto k {:.2g}", smallest, heaviest);
  const auto first = fmt::format("{:.2g}", power), last = fmt::format("{:.2g}", largest_power);
  if (power < 1.0) text += ", power " + (first == last ? first : first + " to " + last);
  if (const std::string search = words_of(searched); !search.empty()) text += ", " + search;
  if (failed == 0) return pass_certificates(m, text, power);
  return fails("FAILS" + seeds_text(failed, m.runs.size()) + ", " + text,
               fmt::format("{}: {}{}", join(faults), join(remedies, ", or "),
                           has_pool ? "; until then its samples are the points that taught its "
                                      "flows, which independent draws don't confirm"
                                    : ""));
}

// That NLE has found modes which NPE, and so the pool, has not; empty where it hasn't.
std::optional<Finding> judge_missed_modes(const MethodResults& m) {
  constexpr double most = 0.1;
  const Vector missed = each(m.runs, [](const EvaluatedRun* run) {
    return run->notes.pool ? run->notes.pool->missed_share : 0.0;
  });
  const Index failed = (missed.array() > most).count();
  if (failed == 0) return std::nullopt;
  const std::string share = fmt::format("{:.0f} %", 100.0 * missed.maxCoeff());
  return fails(
      "a mode is MISSING" + seeds_text(failed, m.runs.size()) + ", " + share,
      fmt::format("{} of the posterior by NLE alone lies where NPE has nothing (fine below "
                  "{:.0f} %), so its samples may lack a mode: simulate more, or compare "
                  "with a method of algorithm \"nle\"",
                  share, 100.0 * most));
}

// Of pooled networks (inference/pooled_posterior.h), which were each right about held-out
// simulations: whether they agree about x_o as they do about those.
Finding judge_pool(const MethodResults& m) {
  if (std::optional<Finding> missing = judge_missed_modes(m)) return *std::move(missing);
  constexpr double least = 0.1;
  Index failed = 0;
  double smallest = 1.0;
  std::string powers;
  for (const EvaluatedRun* run : m.runs) {
    if (!run->notes.pool) continue;  // no feature varies
    const double wanted = run->notes.pool->powers.likelihood;
    const double left = run->notes.pool->powers_at_x_o.likelihood;
    const double share = wanted > 0.0 ? left / wanted : 1.0;
    failed += share < least ? 1 : 0;
    if (share >= smallest) continue;
    smallest = share;
    powers = fmt::format("{:.2g} of {:.2g}", left, wanted);
  }
  if (failed == 0) return passes("");
  return fails("NPE and NLE CONTRADICT each other" + seeds_text(failed, m.runs.size()) +
                   ", power of NLE " + powers,
               "NPE and NLE, whose powers held-out simulations have chosen, contradict each other "
               "at x_o, where that of NLE is " +
                   powers +
                   ": it is like none of the simulations, and NPE alone extrapolates to it: "
                   "simulator or noise lack something" +
                   noise_hint(m.study));
}

Finding judge_chains(const MethodResults& m) {
  const Vector r_hats = each(m.runs, [](const EvaluatedRun* run) {
    const Vector& r_hat = run->evaluation.sampler->r_hat;
    return r_hat.hasNaN() ? kNaN : r_hat.maxCoeff();
  });
  if (r_hats.hasNaN()) {
    return cannot_tell(
        "fewer than four draws of each chain say nothing; raise evaluate.num_samples");
  }
  const Index failed = (r_hats.array() > inference::kLargestRHat).count();
  const std::string text = fmt::format("R-hat {:.3f}", r_hats.maxCoeff());
  if (failed == 0) return passes(text);
  return fails(
      "chains DON'T agree" + seeds_text(failed, m.runs.size()) + ", " + text,
      "its chains are in different places: raise sampler.num_warmup; where modes lie apart, "
      "which no chain crosses, sampler.num_candidates and num_chains");
}

}  // namespace

std::vector<std::string> faults_of(const MethodResults& m, const EvaluatedRun& run) {
  std::vector<std::string> faults = inference::faults_of(*run.notes.certificate);
  if (misses_a_mode(m, run)) {
    faults.emplace_back("its log Z is less than another seed's, so it has missed a mode");
  }
  return faults;
}

template <>
Finding judge<Check::sampling>(const MethodResults& m) {
  if (m.runs.front()->notes.certificate) return judge_certificates(m);
  if (m.is(inference::Algorithm::npe_nle)) return judge_pool(m);
  const bool has_chains = m.runs.front()->evaluation.sampler->r_hat.size() > 0;
  return has_chains ? judge_chains(m) : judge_weights(m);
}

}  // namespace npdr::pipeline
