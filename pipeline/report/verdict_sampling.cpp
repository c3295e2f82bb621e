// Verdicts on how a posterior was sampled: by weights, a pool, a refinement or Markov chains.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/text.h"
#include "pipeline/report/verdict_parts.h"
#include "pipeline/report/verdicts.h"

namespace npdr::pipeline {
namespace {

// Of the weights of draws of the prior.
Verdict judge_weights(const Runs& runs) {
  constexpr double fewest = 100.0;
  double smallest = kInfinity;
  std::size_t failed = 0;
  for (const EvaluatedRun* run : runs) {
    const double size = run->evaluation.sampler->ess.minCoeff();
    failed += size < fewest ? 1 : 0;
    smallest = std::min(smallest, size);
  }
  const std::string text = fmt::format("effective size {:.3g}", smallest);
  if (failed == 0) return {Check::sampling, Judgment::passes, "passes, " + text, ""};
  return {Check::sampling, Judgment::fails,
          "too few DIFFERENT draws" + seeds_text(failed, runs.size()) + ", " + text,
          fmt::format("its samples repeat draws of the prior, of which {:.3g} count: raise "
                      "sampler.num_candidates, or take sampler.kind = \"slice\"",
                      smallest)};
}

// What mends the faults of a refined posterior.
std::vector<std::string> remedies_of(const ReportData& data,
                                     const inference::ImportanceCertificate& certificate) {
  const bool is_heavy = has_heavy_weights(certificate);
  std::vector<std::string> remedies;
  if (std::ssize(faults_of(certificate)) > (is_heavy ? 1 : 0)) {
    remedies.emplace_back("raise refine.max_simulations");
  }
  if (certificate.power < certificate.wanted_power) {
    remedies.emplace_back(data.plan.study.source().gives_motion && data.target.num_rollouts() > 1
                              ? "let refine.cross_validate choose a smaller power"
                              : "lower refine.likelihood_power");
  }
  if (is_heavy) remedies.emplace_back("raise refine.level_size for heavy weights");
  return remedies;
}

// Whether another seed has found what this one's draws have missed. In an outer loop each seed has
// an observation of its own.
bool misses_a_mode(const ReportData& data, const EvaluatedRun& run, const Runs& runs) {
  const Study& study = data.plan.study;
  if (study.num_iterations_of(study.method(run.use.method)) > 1) return false;
  return std::ranges::any_of(runs, [&](const EvaluatedRun* other) {
    return finds_less(*run.notes.certificate, *other->notes.certificate);
  });
}

void add_new(std::vector<std::string>& all, const std::vector<std::string>& more) {
  std::ranges::copy_if(more, std::back_inserter(all), [&](const std::string& text) {
    return std::ranges::find(all, text) == all.end();
  });
}

// Power below which the recording hardly counts.
constexpr double kSmallPower = 0.05;

// The largest power that predicts left-out rollouts about as well as that of every run.
double largest_as_good(const Runs& runs) {
  double largest = 1.0;
  for (const EvaluatedRun* run : runs) {
    const bool has_chosen = run->notes.powers.power.size() > 0;
    largest = std::min(
        largest, has_chosen ? run->notes.powers.largest_as_good() : run->notes.certificate->power);
  }
  return largest;
}

// What a power says of the simulator, where the recording hardly counts.
std::string words_of(double power, double as_good, bool is_smallest) {
  if (power >= kSmallPower) return "";
  if (as_good >= kSmallPower) {
    return fmt::format(
        "powers from {:.2g} to {:.2g} predict rollouts that are left out about as well, and the "
        "smallest of them is taken: so few rollouts don't tell whether the simulator lacks "
        "something; more of them do, and where it is known to be right, and first states are exact "
        "or inferred, likelihood_power = 1 without cross_validate",
        power, as_good);
  }
  return fmt::format(
      "it believes the recording to a power of {:.2g}{}: simulator or noise are far from it; look "
      "for what they lack",
      power,
      is_smallest ? ", the smallest that was tried, which predicts rollouts that are left out "
                    "about as well as any, and at which it may still be too narrow"
                  : "");
}

// Whether larger powers than the first one predict hardly better.
bool is_smallest_tried(const EvaluatedRun& run) {
  const Vector& tried = run.notes.powers.power;
  return tried.size() > 1 && run.notes.certificate->wanted_power <= tried(0);
}

// Whether a method's search for the power ended before it had seen enough.
bool is_search_cut(const ReportData& data, const Runs& runs) {
  const Study& study = data.plan.study;
  return std::ranges::any_of(runs, [&](const EvaluatedRun* run) {
    return run->notes.powers.ends_at_least(
        study.method(run->use.method).refine.sampling.likelihood_power);
  });
}

std::string text_of_powers(double smallest, double largest) {
  if (!(smallest < 1.0)) return "";
  const std::string first = fmt::format("{:.2g}", smallest), last = fmt::format("{:.2g}", largest);
  return ", power " + (first == last ? first : first + " to " + last);
}

// Where all certificates hold. `power`: the smallest.
Verdict pass_certificates(const ReportData& data, const Runs& runs, const std::string& text,
                          double power) {
  if (is_search_cut(data, runs)) {
    return {Check::sampling, Judgment::passes, text,
            "the largest power that was reached predicts rollouts that are left out best, and "
            "larger ones may do better: raise refine.max_simulations"};
  }
  const bool is_smallest = std::ranges::all_of(runs, [&](const EvaluatedRun* run) {
    return run->notes.certificate->power > power || is_smallest_tried(*run);
  });
  return {Check::sampling, Judgment::passes, text,
          words_of(power, largest_as_good(runs), is_smallest)};
}

// Of refined posteriors: the certificates of their draws.
Verdict judge_certificates(const ReportData& data, const Runs& runs) {
  std::vector<std::string> faults, remedies;
  std::size_t failed = 0;
  double smallest = kInfinity, heaviest = -kInfinity, power = 1.0, largest_power = 0.0;
  bool has_pool = false;
  for (const EvaluatedRun* run : runs) {
    const inference::ImportanceCertificate& certificate = *run->notes.certificate;
    std::vector<std::string> its = faults_of(certificate);
    add_new(remedies, remedies_of(data, certificate));
    if (misses_a_mode(data, *run, runs)) {
      its.emplace_back("its log Z is less than another seed's, so it has missed a mode");
      add_new(remedies, {"raise refine.level_size for modes"});
    }
    failed += its.empty() ? 0 : 1;
    add_new(faults, its);
    smallest = std::min(smallest, certificate.ess);
    heaviest = std::max(heaviest, certificate.pareto_k);
    power = std::min(power, certificate.power);
    largest_power = std::max(largest_power, certificate.power);
    has_pool |= certificate.ess_of_all > 0.0;
  }
  const std::string text =
      fmt::format(", effective size {:.0f}, Pareto k {:.2g}", smallest, heaviest) +
      text_of_powers(power, largest_power);
  if (failed == 0) return pass_certificates(data, runs, "passes" + text, power);
  return {Check::sampling, Judgment::fails,
          "its draws DON'T hold" + seeds_text(failed, runs.size()) + text,
          fmt::format("{}: {}{}", join(faults), join(remedies, ", or "),
                      has_pool ? "; until then its samples are the points that taught its flows, "
                                 "which independent draws don't confirm"
                               : "")};
}

// Of pooled networks (inference/pooled_posterior.h), which were each right about held-out
// simulations: whether they agree about x_o as they do about those.
Verdict judge_pool(const ReportData& data, const Runs& runs) {
  constexpr double least = 0.1, telling = 0.5;
  std::size_t failed = 0;
  double smallest = 1.0;
  std::string powers;
  for (const EvaluatedRun* run : runs) {
    if (!run->notes.pool) continue;  // no feature varies
    const double wanted = run->notes.pool->powers.likelihood;
    const double left = run->notes.pool->powers_at_x_o.likelihood;
    const double share = wanted > 0.0 ? left / wanted : 1.0;
    failed += share < least ? 1 : 0;
    if (share >= smallest) continue;
    smallest = share;
    powers = fmt::format("{:.2g} of {:.2g}", left, wanted);
  }
  const std::string advice = "simulator or noise lack something" + noise_hint(data.plan.study);
  if (failed > 0) {
    return {
        Check::sampling, Judgment::fails,
        "NPE and NLE CONTRADICT each other" + seeds_text(failed, runs.size()) + ", power of NLE " +
            powers,
        "NPE and NLE, whose powers held-out simulations have chosen, contradict each other at "
        "x_o, where that of NLE is " +
            powers +
            ": it is like none of the simulations, and NPE alone extrapolates to it: " + advice};
  }
  const std::string reason =
      "NPE and NLE agree less about x_o than about held-out simulations, the "
      "power of NLE is " +
      powers + ": chance, or " + advice;
  return {Check::sampling, Judgment::passes, "passes", smallest < telling ? reason : ""};
}

}  // namespace

Verdict judge_sampling(const ReportData& data, const std::string& method) {
  const Runs runs = data.runs_of(method);
  if (runs.front()->notes.certificate) return judge_certificates(data, runs);
  const inference::Algorithm algorithm = data.plan.study.method(method).algorithm.kind;
  if (algorithm == inference::Algorithm::npe_nle) return judge_pool(data, runs);
  if (runs.front()->evaluation.sampler->r_hat.size() == 0) return judge_weights(runs);
  double largest = 0.0;
  std::size_t failed = 0;
  for (const EvaluatedRun* run : runs) {
    const Vector& r_hat = run->evaluation.sampler->r_hat;
    if (r_hat.hasNaN()) {
      return {Check::sampling, Judgment::unknown, "can't tell",
              "fewer than four draws of each chain say nothing; raise evaluate.num_samples"};
    }
    failed += r_hat.maxCoeff() > kLargestRHat ? 1 : 0;
    largest = std::max(largest, r_hat.maxCoeff());
  }
  const std::string text = fmt::format(", R-hat {:.3f}", largest);
  if (failed == 0) return {Check::sampling, Judgment::passes, "passes" + text, ""};
  return {Check::sampling, Judgment::fails,
          std::string(traits_of(Check::sampling).failure) + seeds_text(failed, runs.size()) + text,
          "its chains are in different places: raise sampler.num_warmup; where modes lie apart, "
          "which no chain crosses, sampler.num_candidates and num_chains"};
}

}  // namespace npdr::pipeline
