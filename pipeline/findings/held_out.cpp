// What a posterior's samples predict of rollouts that inference hasn't seen.
#include <fmt/format.h>

#include <algorithm>

#include "core/constants.h"
#include "inference/diagnostics/bound_pressure.h"
#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

// What would make predictions less sure of themselves.
std::string advice_to_widen(const MethodResults& m) {
  const bool is_refined = m.is(inference::Algorithm::refine);
  if (m.method.refine.sampling.cross_validate) return advice_on_model(m.study);
  if (m.study.target.num_rollouts > 1) {
    return is_refined
               ? "Set cross_validate = true in [method.refine]"
               : "Add a [[method]] with algorithm = \"refine\" and refine.cross_validate = true";
  }
  return is_refined ? "Lower likelihood_power in [method.refine]" : advice_on_model(m.study);
}

// Of the posterior's CRPS to that without inference: where the motion tells little, either may be
// smaller.
constexpr double kFarWorse = 1.2;

// Means over channels, with noise where there is any.
double crps_of(const PredictionScores& scores) {
  return (scores.noisy_crps.size() > 0 ? scores.noisy_crps : scores.crps).mean();
}
double covered_by(const PredictionScores& scores) {
  const auto level = std::ranges::find(kBandLevels, kJudgedBand) - kBandLevels.begin();
  const bool has_noise = scores.noisy_coverage.size() > 0;
  return (has_noise ? scores.noisy_coverage : scores.coverage).row(level).mean();
}

// What predicts held-out rollouts best without any inference, and its CRPS: draws of the prior or,
// of recordings, the nominal parameters, which may be a simulated target's truth.
std::pair<std::string, double> uninformed(const ReportData& data) {
  std::pair<std::string, double> best{"", kInfinity};
  const auto consider = [&](const std::string& whose, const RolloutScores& scores) {
    if (scores.held_out && crps_of(*scores.held_out) < best.second) {
      best = {whose, crps_of(*scores.held_out)};
    }
  };
  if (data.baseline.prior) consider("the prior", data.baseline.prior->scores);
  if (data.plan.study.target.truth) return best;
  for (const BaselinePoint& point : data.baseline.points) {
    if (point.name == "nominal") consider("the nominal parameters", point.scores);
  }
  return best;
}

// What the runs predict of held-out rollouts.
struct HeldOut {
  Index narrow = 0, worse = 0;  ///< runs whose bands are too narrow, that predict worse
  double least = 1.0;           ///< share that bands hold; of the narrow ones, if any are
  double worst = 0.0;           ///< CRPS
};

HeldOut held_out_of(const Runs& runs, double of_uninformed) {
  HeldOut all;
  double least_narrow = 1.0;
  for (const EvaluatedRun* run : runs) {
    const PredictionScores& scores = *run->evaluation.scores.held_out;
    const double covered = covered_by(scores);
    all.least = std::min(all.least, covered);
    all.worst = std::max(all.worst, crps_of(scores));
    all.worse += crps_of(scores) > kFarWorse * of_uninformed ? 1 : 0;
    if (scores.share_as_seldom_within > 0.0) continue;
    ++all.narrow;
    least_narrow = std::min(least_narrow, covered);
  }
  if (all.narrow > 0) all.least = least_narrow;
  return all;
}

}  // namespace

// A rollout that inference hasn't seen, predicted by independent draws of a posterior that is
// right, is one more draw: not one of n draws lies within the bands as seldom with a probability of
// 1 / (n + 1). Its bands hold a share that is 0.9 in expectation, and so below one half with a
// probability of (1 - 0.9) / (1 - 0.5) at most (Markov).
template <>
Findings judge<Check::held_out>(const MethodResults& m) {
  constexpr double few = 0.5;
  for (const EvaluatedRun* run : m.runs) {
    const Index count = run->evaluation.scores.held_out->num_compared;
    if (count < inference::kFewestForBounds) return {too_few_samples(count)};
  }
  const auto [whose, of_uninformed] = uninformed(m.data);
  const auto [narrow, worse, least, worst] = held_out_of(m.runs, of_uninformed);
  const std::string bands = fmt::format("{:.0f} % of the recorded states lie in {:.0f} % bands",
                                        100.0 * least, 100.0 * kJudgedBand);
  const std::size_t all = m.runs.size();
  if (narrow > 0 && !infers_first_states(m)) {
    return {fails(
        {.id = "narrow",
         .what = "error bars of predictions are too small, by held-out rollouts",
         .evidence = bands + " (simulated recordings never have so few)" + seeds_text(narrow, all),
         .advice = advice_to_widen(m)})};
  }
  if (worse > 0) {
    return {fails({.id = "worse",
                   .what = fmt::format("held-out rollouts are predicted worse than by {}", whose),
                   .evidence = fmt::format("error (CRPS) {:.2g} (fine below {:.2g}){}", worst,
                                           kFarWorse * of_uninformed, seeds_text(worse, all)),
                   .advice = advice_on_model(m.study)})};
  }
  if (narrow > 0) {
    return {cannot_tell({.what = "predictions begin in noisy recorded states, which may move all "
                                 "of a rollout",
                         .evidence = bands,
                         .advice = m.is(inference::Algorithm::refine)
                                       ? "Read the check of residuals instead"
                                       : "Compare with a refinement that has infer_first_states = "
                                         "true"})};
  }
  if (least < few) {
    return {cannot_tell({.what = "few recorded states lie in the predicted bands, as may happen to "
                                 "a right posterior",
                         .evidence = bands,
                         .advice = "Raise held_out in [target]"})};
  }
  return {passes({.evidence = bands})};
}

}  // namespace npdr::pipeline
