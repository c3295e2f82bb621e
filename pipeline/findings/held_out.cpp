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
  const std::string model = "look for what simulator or noise lack" + noise_hint(m.study);
  if (m.method.refine.sampling.cross_validate) return model;
  if (m.study.target.num_rollouts > 1) return "refine with refine.cross_validate, or " + model;
  return m.is(inference::Algorithm::refine) ? "lower refine.likelihood_power, or " + model : model;
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
  if (data.baseline.prior) consider("the prior's", data.baseline.prior->scores);
  if (data.plan.study.target.truth) return best;
  for (const BaselinePoint& point : data.baseline.points) {
    if (point.name == "nominal") consider("the nominal parameters'", point.scores);
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
Finding judge<Check::held_out>(const MethodResults& m) {
  constexpr double few = 0.5;
  for (const EvaluatedRun* run : m.runs) {
    const Index count = run->evaluation.scores.held_out->num_compared;
    if (count < inference::kFewestForBounds) return too_few_samples(count);
  }
  const auto [whose, of_uninformed] = uninformed(m.data);
  const auto [narrow, worse, least, worst] = held_out_of(m.runs, of_uninformed);
  const std::string bands =
      fmt::format("bands of {:.0f} % hold {:.0f} %", 100.0 * kJudgedBand, 100.0 * least);
  const std::string unseen = " of rollouts that inference hasn't seen";
  const std::string hold_few = bands + unseen, advice = advice_to_widen(m);
  const std::size_t all = m.runs.size();
  if (narrow > 0 && !m.method.refine.infer_first_states) {
    return fails("predictions are TOO NARROW" + seeds_text(narrow, all) + ", " + bands,
                 hold_few +
                     ", and more of what any of its own samples predicts: it knows parameters or "
                     "noise less well than it says: " +
                     advice);
  }
  if (worse > 0) {
    return fails("predictions are WORSE than " + whose + seeds_text(worse, all) + ", " + bands,
                 fmt::format("the CRPS of its predictions{} is {:.2g}, that of {} {:.2g}: {}",
                             unseen, worst, whose, of_uninformed, advice));
  }
  if (narrow > 0) {
    return cannot_tell(
        hold_few +
            ", but predictions begin in recorded first states, whose noise moves all of a "
            "rollout, some far more than others: a right posterior's bands may hold too few; "
            "the check of residuals tells more",
        "can't tell, " + bands);
  }
  if (least < few) {
    return cannot_tell(
        hold_few +
            ", a right posterior's less than half with a probability of 0.2 at most; but some of "
            "its samples' own predictions are held as seldom: " +
            advice,
        "can't tell, " + bands);
  }
  return passes(bands);
}

}  // namespace npdr::pipeline
