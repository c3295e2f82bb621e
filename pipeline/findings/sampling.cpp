// How a posterior was sampled: by weights, a pool, a refinement or Markov chains.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/constants.h"
#include "inference/samplers/chain_diagnostics.h"
#include "inference/samplers/importance_constants.h"
#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

// Of the weights of draws of the prior.
Findings judge_weights(const MethodResults& m) {
  constexpr double fewest = 100.0;
  const Vector sizes =
      each(m.runs, [](const EvaluatedRun* run) { return run->evaluation.sampler->ess.minCoeff(); });
  const Index failed = (sizes.array() < fewest).count();
  const std::string size =
      fmt::format("effective size {:.3g} (fine from {:.0f} on)", sizes.minCoeff(), fewest);
  if (failed == 0) return {passes({.evidence = size})};
  return {fails({.id = "weights",
                 .what = "many samples are copies of a few",
                 .evidence = size + seeds_text(failed, m.runs.size()),
                 .advice = "Raise num_candidates in [method.sampler]"})};
}

// Whether another seed has found what this one's draws have missed.
bool misses_a_mode(const MethodResults& m, const EvaluatedRun& run) {
  return !m.has_outer_loop() && std::ranges::any_of(m.runs, [&](const EvaluatedRun* other) {
    return finds_less(*run.notes.certificate, *other->notes.certificate);
  });
}

// By how much the log evidence of a run is below the largest of the seeds'.
double evidence_behind(const MethodResults& m, const EvaluatedRun& run) {
  const Vector all = each(
      m.runs, [](const EvaluatedRun* other) { return other->notes.certificate->log_evidence; });
  return all.maxCoeff() - run.notes.certificate->log_evidence;
}

// Where all certificates hold. `power`: the smallest.
Findings remarks_on_power(const MethodResults& m, double power) {
  constexpr double small = 0.05;
  const std::string evidence = fmt::format("power {:.2g} (1: the recording counts whole)", power);
  const bool is_search_cut = std::ranges::any_of(m.runs, [&](const EvaluatedRun* run) {
    return run->notes.powers.ends_at_least(m.method.refine.sampling.likelihood_power);
  });
  if (is_search_cut) {
    return {passes({.id = "power",
                    .what = "the search for the power may have ended too early",
                    .evidence = evidence,
                    .advice = "Raise max_simulations in [method.refine]"})};
  }
  if (power >= small) return {};
  const bool is_chosen = std::ranges::any_of(
      m.runs, [](const EvaluatedRun* run) { return run->notes.powers.power.size() > 0; });
  return {passes(
      {.id = "power",
       .what = is_chosen ? "cross-validation trusts the simulator so little that the recording "
                           "hardly counts"
                         : "the recording hardly counts, as likelihood_power is so low",
       .evidence = evidence,
       .advice = is_chosen || m.data.target.num_rollouts() < 2
                     ? advice_on_model(m.study)
                     : "Set cross_validate = true in [method.refine]"})};
}

// Of refined posteriors: the certificates of their draws.
Findings judge_certificates(const MethodResults& m) {
  std::vector<std::string> faults;
  Index failed = 0;
  bool is_any_heavy = false, lacks_simulations = false;
  double smallest = kInfinity, wanted = 0.0, heaviest = -kInfinity, power = 1.0, behind = 0.0;
  for (const EvaluatedRun* run : m.runs) {
    const inference::ImportanceCertificate& certificate = *run->notes.certificate;
    const std::vector<std::string> its = faults_of(m, *run);
    std::ranges::copy_if(its, std::back_inserter(faults), [&](const std::string& fault) {
      return std::ranges::count(faults, fault) == 0;
    });
    const bool is_heavy = has_heavy_weights(certificate);
    failed += its.empty() ? 0 : 1;
    is_any_heavy |= is_heavy;
    lacks_simulations |= std::ssize(inference::faults_of(certificate)) > (is_heavy ? 1 : 0);
    if (misses_a_mode(m, *run)) behind = std::max(behind, evidence_behind(m, *run));
    smallest = std::min(smallest, certificate.ess);
    wanted = std::max(wanted, certificate.wanted_ess);
    if (!(certificate.pareto_k <= heaviest)) heaviest = certificate.pareto_k;  // also NaN
    power = std::min(power, certificate.power);
  }
  std::string size =
      is_any_heavy && !lacks_simulations
          ? fmt::format("Pareto k {:.2g} (fine up to {:.2g})", heaviest, inference::kLargestParetoK)
          : fmt::format("effective size {:.0f} (wanted: {:.0f})", smallest, wanted);
  if (behind > 0.0 && !lacks_simulations && !is_any_heavy) {
    size = fmt::format("log evidence {:.1f} below another seed's (the same: 0)", behind);
  }
  if (power < 1.0) size += fmt::format(", power {:.2g}", power);
  if (failed > 0) {
    return {fails({.id = "certificate",
                   .what = "the refinement's draws cannot be trusted: " + listed(faults),
                   .evidence = size + seeds_text(failed, m.runs.size()),
                   .advice = lacks_simulations ? "Raise max_simulations in [method.refine]"
                                               : "Raise level_size in [method.refine]"})};
  }
  Findings found = {passes({.evidence = size})};
  append(found, remarks_on_power(m, power));
  return found;
}

// That NLE has found modes which NPE, and so the pool, has not.
Findings find_missed_modes(const MethodResults& m) {
  constexpr double most = 0.1;
  const Vector missed = each(m.runs, [](const EvaluatedRun* run) {
    return run->notes.pool ? run->notes.pool->missed_share : 0.0;
  });
  const Index failed = (missed.array() > most).count();
  if (failed == 0) return {};
  return {fails({.id = "modes",
                 .what = "the samples may lack a mode, which NLE has found and NPE has not",
                 .evidence = fmt::format("{:.0f} % of the posterior by NLE (fine up to {:.0f} %){}",
                                         100.0 * missed.maxCoeff(), 100.0 * most,
                                         seeds_text(failed, m.runs.size())),
                 .advice = "Raise num_simulations in [[method]]"})};
}

// Of pooled networks (inference/pooled_posterior.h), which were each right about held-out
// simulations: whether they agree about x_o as they do about those.
Findings judge_pool(const MethodResults& m) {
  if (Findings missing = find_missed_modes(m); !missing.empty()) return missing;
  constexpr double least = 0.1;
  Index failed = 0;
  double smallest = 1.0;
  std::string power;
  for (const EvaluatedRun* run : m.runs) {
    if (!run->notes.pool) continue;  // no feature varies
    const double wanted = run->notes.pool->powers.likelihood;
    const double left = run->notes.pool->powers_at_x_o.likelihood;
    const double share = wanted > 0.0 ? left / wanted : 1.0;
    failed += share < least ? 1 : 0;
    if (share >= smallest) continue;
    smallest = share;
    power =
        fmt::format("the weight of NLE fell to {:.2g} (fine from {:.2g} on)", left, least * wanted);
  }
  if (failed == 0) return {passes({.evidence = power})};
  return {fails(
      {.id = "pool",
       .what = "the two networks, NPE and NLE, find different parameters for this observation",
       .evidence = power + seeds_text(failed, m.runs.size()),
       .advice = advice_on_noise(m.study, advice_on_model(m.study))})};
}

Findings judge_chains(const MethodResults& m) {
  const Vector r_hats = each(m.runs, [](const EvaluatedRun* run) {
    const Vector& r_hat = run->evaluation.sampler->r_hat;
    return r_hat.hasNaN() ? kNaN : r_hat.maxCoeff();
  });
  if (r_hats.hasNaN()) {
    return {cannot_tell({.what = "chains have too few draws to be compared",
                         .evidence = "fewer than 4 draws of each chain",
                         .advice = "Raise num_samples in [evaluate]"})};
  }
  const Index failed = (r_hats.array() > inference::kLargestRHat).count();
  const std::string size =
      fmt::format("R-hat {:.3f} (fine up to {:.1f})", r_hats.maxCoeff(), inference::kLargestRHat);
  if (failed == 0) return {passes({.evidence = size})};
  return {fails(
      {.id = "chains",
       .what =
           "the Markov chains that sample stayed in different places, so that samples are wrong",
       .evidence = size + seeds_text(failed, m.runs.size()),
       .advice = "Raise num_warmup in [method.sampler]"})};
}

}  // namespace

std::vector<std::string> faults_of(const MethodResults& m, const EvaluatedRun& run) {
  std::vector<std::string> faults = inference::faults_of(*run.notes.certificate);
  if (misses_a_mode(m, run)) {
    faults.emplace_back("another seed has found a mode that it missed");
  }
  return faults;
}

template <>
Findings judge<Check::sampling>(const MethodResults& m) {
  if (m.runs.front()->notes.certificate) return judge_certificates(m);
  if (m.is(inference::Algorithm::npe_nle)) return judge_pool(m);
  const bool has_chains = m.runs.front()->evaluation.sampler->r_hat.size() > 0;
  return has_chains ? judge_chains(m) : judge_weights(m);
}

}  // namespace npdr::pipeline
