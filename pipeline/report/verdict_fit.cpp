// Verdicts on what a posterior's samples predict, of rollouts that inference has seen and of
// others.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/scatter.h"
#include "core/constants.h"
#include "core/quantile.h"
#include "core/text.h"
#include "inference/diagnostics/bound_pressure.h"
#include "pipeline/features/noise.h"
#include "pipeline/report/verdict_parts.h"
#include "pipeline/report/verdicts.h"

namespace npdr::pipeline {
namespace {

// The recorded states are at most 1 in its units, and 0 explains a swing with less. Where a model
// is right the floor is what noise leaves.
constexpr double kFarFloor = 0.5;

// What a posterior's RMSE is compared with: what the best of the prior reaches, or the truth, or
// the noise, below which the observation hardly tells parameters apart.
// Without noise the truth reaches zero, which no sample does: there a tenth of the prior's is small
// enough.
struct Yardstick {
  double limit = 0.0;
  double unit = 0.0;  ///< "30 times the floor's", "20 % of the prior's"
  std::string words;

  std::string text_of(double rmse) const {
    const double times = rmse / unit;
    return times < 10.0 ? fmt::format("{:.2g} {}", times, words)
                        : fmt::format("{:.0f} {}", times, words);
  }
};

double median_of(const Vector& values) { return quantile_of_sorted(sorted_finite(values), 0.5); }

// What noise of a known scale leaves of the observation at the truth, in RMSE's unit; 0 without it.
double known_noise(const ReportData& data) {
  const ObservationNoise& stated = data.plan.study.observation_noise;
  if (stated.scale_prior || !(stated.scale > 0.0 || stated.std)) return 0.0;
  return noise_model(data.plan.study, data.target).relative_size().mean();
}

std::optional<Yardstick> yardstick(const ReportData& data) {
  const std::string rmse = name_of(Metric::rmse);
  const double of_prior = median_of(data.baseline.prior->metrics.at(rmse));
  Yardstick found;
  if (of_prior > 0.0) found = {0.1 * of_prior, 0.01 * of_prior, "% of the prior's"};
  for (const BaselinePoint& point : data.baseline.points) {
    if (point.name != "floor" && point.name != "truth") continue;
    const double reached = point.metrics.at(rmse);
    if (3.0 * reached > found.limit) {
      found = {3.0 * reached, reached, "times the " + point.name + "'s"};
    }
  }
  const double noise = std::min(known_noise(data), kFarFloor);
  if (noise > found.limit) found = {noise, noise, "times the noise"};
  if (found.limit > 0.0) return found;
  return std::nullopt;
}

// Samples that explain the observation no better than half of the prior's, where the rest does far
// better, belong to a mode that isn't there.
constexpr double kFarBetter = 3.0;
constexpr double kMostStrays = 0.1;

// Their share of the samples whose rollouts succeeded; 0 where the rest isn't far better, and where
// there are too few to tell.
double share_of_strays(const Vector& rmse, double of_prior) {
  const Index count = rmse.array().isFinite().count();
  if (count < inference::kFewestForBounds || !(of_prior > kFarBetter * median_of(rmse))) return 0.0;
  const Index strays = (rmse.array().isFinite() && rmse.array() > of_prior).count();
  return static_cast<double>(strays) / static_cast<double>(count);
}

// The smallest RMSE of any parameters of the prior; 0 where it wasn't looked for.
double floor_of(const ReportData& data) {
  for (const BaselinePoint& point : data.baseline.points) {
    if (point.name == "floor") return point.metrics.at(name_of(Metric::rmse));
  }
  return 0.0;
}

// What the best parameters leave of the observation, where noise doesn't say that they leave it.
std::string understated_noise(double noise, double of_floor) {
  constexpr double far_more = 3.0;
  if (of_floor < far_more * noise) return "";
  return fmt::format(
      "no parameters explain the observation better than the floor's {:.2g}, {:.0f} times the "
      "noise: raise observation_noise towards it, or look for what the simulator lacks",
      of_floor, of_floor / noise);
}

// White noise of a recording is what the best parameters leave of it, but for the little that they
// take away of so many numbers. The size of heavy tails may be that of a few numbers, which a
// recording needn't have.
std::string overstated_noise(const Study& study, double noise, double of_floor) {
  constexpr double far_more = 3.0;
  const ObservationNoise& stated = study.observation_noise;
  const bool is_white = !stated.correlation && !stated.correlation_prior;
  const bool is_gaussian = !stated.degrees_of_freedom && !stated.degrees_of_freedom_prior;
  if (!study.target.recording || !is_white || !is_gaussian || of_floor == 0.0 ||
      noise < far_more * of_floor) {
    return "";
  }
  return fmt::format(
      "the best parameters leave {:.2g} of the recording, the noise is {:.0f} times as large: "
      "lower observation_noise, or posteriors say less than the recording does",
      of_floor, noise / of_floor);
}

// The same where no noise is stated; one whose scale is inferred takes up what the simulator lacks,
// as one that is much larger than what the recording scatters by shows.
std::string unexplained_rest(const ReportData& data, double of_floor) {
  // Coarse encoders, and rates that are computed of them, leave up to four times what they scatter
  // by.
  constexpr double of_usual_sensors = 0.05, far_more = 8.0;
  const Study& study = data.plan.study;
  const ObservationNoise& noise = study.observation_noise;
  if (!study.target.recording) return "";
  const bool is_white = !noise.correlation && !noise.correlation_prior;
  const double scatter = is_white ? analysis::scatter_of(data.target) : 0.0;
  const bool is_structured = scatter > 0.0 && of_floor > far_more * scatter;
  if (of_floor < of_usual_sensors && !is_structured) return "";
  const std::string found = fmt::format(
      "no parameters explain the recording better than the floor's {:.2g} of its largest "
      "magnitudes",
      of_floor);
  const bool may_hold_out = data.plan.target.num_rollouts() > 1 && study.target.held_out == 0 &&
                            study.evaluate.leave_out == 0;
  const std::string hint =
      may_hold_out ? "; target.held_out shows what that costs predictions" : "";
  if (!is_structured) {
    return fmt::format(
        "{}: unless its sensors are that noisy, or the simulator draws at random, look for what "
        "the simulator lacks{}",
        found, hint);
  }
  const double times = of_floor / scatter;
  return fmt::format(
      "{}, {} what neighboring samples scatter by: unless the noise lasts for many "
      "samples, or first states are noisy, the simulator lacks something (a delay, friction), "
      "parameters make up for it, and the truth may be many deviations away{}",
      found, times < 100.0 ? fmt::format("{:.0f} times", times) : "far above", hint);
}

std::string what_the_best_leave(const ReportData& data, double of_floor) {
  const double noise = known_noise(data);
  if (noise == 0.0) return unexplained_rest(data, of_floor);
  const std::string understated = understated_noise(noise, of_floor);
  return understated.empty() ? overstated_noise(data.plan.study, noise, of_floor) : understated;
}

// Networks leave what more simulations near the recording would find.
std::string room_to_learn(const ReportData& data, const std::string& method, double rmse,
                          double of_floor) {
  constexpr double more = 2.0;
  const Study& study = data.plan.study;
  const bool is_refined = study.method(method).algorithm.kind == inference::Algorithm::refine;
  if (!study.target.recording || is_refined || of_floor == 0.0 || rmse < more * of_floor) return "";
  return fmt::format(
      "its samples are {:.2g} times as far from the recording as the best parameters: a method "
      "with algorithm = \"refine\" and refine.start = \"{}\" finds what is between",
      rmse / of_floor, method);
}

Verdict unexplained(double rmse) {
  return {
      Check::fit, Judgment::fails, fmt::format("NO parameters fit, {:.2g} at best", rmse),
      fmt::format("the smallest RMSE of any parameters of the prior is {:.2g} of the largest "
                  "recorded magnitude: look at units, clock, and sign and zero of the angles of "
                  "the recording, or widen the prior",
                  rmse)};
}

// What would make predictions of rollouts that inference hasn't seen less sure of themselves.
std::string advice_to_widen(const ReportData& data, const std::string& method) {
  const MethodConfig& config = data.plan.study.method(method);
  const std::string model = "look for what simulator or noise lack" + noise_hint(data.plan.study);
  if (config.refine.sampling.cross_validate) return model;
  const bool has_folds = data.plan.study.target.num_rollouts > 1;
  const bool is_refined = config.algorithm.kind == inference::Algorithm::refine;
  if (!has_folds) return is_refined ? "lower refine.likelihood_power, or " + model : model;
  return (is_refined ? "let refine.cross_validate choose the power of the likelihood, or "
                     : "refine it with refine.cross_validate, or ") +
         model;
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

// What predicts held-out rollouts best without any inference.
struct Uninformed {
  std::string whose;
  double crps = kInfinity;
};

// Draws of the prior or, of recordings, the nominal parameters, which may be a
// simulated target's truth.
Uninformed uninformed(const ReportData& data) {
  Uninformed best;
  const auto consider = [&](const std::string& whose, const RolloutScores& scores) {
    if (scores.held_out && crps_of(*scores.held_out) < best.crps) {
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
  std::size_t narrow = 0, worse = 0;  ///< runs whose bands are too narrow, that predict worse
  double least = 1.0;                 ///< share that bands hold; of the narrow ones, if any are
  double worst = 0.0;                 ///< CRPS
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

// Rounds simulate where the posterior of the first one is, right or not.
std::string word_of_rounds(const ReportData& data, const std::string& method) {
  const inference::Algorithm algorithm = data.plan.study.method(method).algorithm.kind;
  const inference::AlgorithmTraits& traits = inference::traits_of(algorithm);
  const bool is_trained = traits.family == inference::AlgorithmFamily::network ||
                          traits.family == inference::AlgorithmFamily::abc;
  if (!data.plan.study.source().simulates || !is_trained || traits.has_one_round) return "";
  if (!is_miscalibrated(data, method)) return ", more rounds";
  return "; rounds go on from the posterior of round 1, whose calibration FAILS: mend that first";
}

}  // namespace

Verdict judge_fit(const ReportData& data, const std::string& method) {
  const double of_floor = floor_of(data);
  if (of_floor > kFarFloor) return unexplained(of_floor);
  const std::optional<Yardstick> reached = yardstick(data);
  const double of_prior = median_of(data.baseline.prior->metrics.at(name_of(Metric::rmse)));
  const Runs runs = data.runs_of(method);
  std::size_t failed = 0, astray = 0;
  double worst = 0.0, strays = 0.0;
  for (const EvaluatedRun* run : runs) {
    const Vector& its = run->evaluation.metrics.at(name_of(Metric::rmse));
    const double median = median_of(its);
    if (!reached || std::isnan(median)) {
      return {Check::fit, Judgment::unknown, "can't tell",
              "no rollout succeeded that an RMSE could be measured of"};
    }
    failed += median > reached->limit ? 1 : 0;
    worst = std::max(worst, median);
    const double share = share_of_strays(its, of_prior);
    astray += share > kMostStrays ? 1 : 0;
    strays = std::max(strays, share);
  }
  const std::string size = reached->text_of(worst);
  const std::string advice = (is_noise_unstated(data.plan.study)
                                  ? "observation_noise.scale, which the study doesn't state, "
                                  : "") +
                             advice_to_learn(data, method);
  if (failed > 0) {
    return {
        Check::fit, Judgment::fails,
        std::string(traits_of(Check::fit).failure) + seeds_text(failed, runs.size()) + ", " + size,
        fmt::format("{:.3g} is the median RMSE of its samples, {}: try {}{}", worst, size, advice,
                    word_of_rounds(data, method))};
  }
  if (astray == 0) {
    std::vector<std::string> notes = {what_the_best_leave(data, of_floor),
                                      room_to_learn(data, method, worst, of_floor)};
    std::erase(notes, "");
    return {Check::fit, Judgment::passes, "passes, " + size, join(notes, "; ")};
  }
  return {
      Check::fit, Judgment::fails,
      fmt::format("{:.0f} % of its samples are FAR off{}", 100.0 * strays,
                  seeds_text(astray, runs.size())),
      fmt::format("their RMSE is above {:.3g}, the median of the prior's; that of all of them "
                  "is {:.3g}: a mode that isn't there; try {}, or a refinement of its posterior",
                  of_prior, worst, advice)};
}

// A rollout that inference hasn't seen, predicted by independent draws of a posterior that is
// right, is one more draw: not one of n draws lies within the bands as seldom with a probability of
// 1 / (n + 1). Its bands hold a share that is 0.9 in expectation, and so below one half with a
// probability of (1 - 0.9) / (1 - 0.5) at most (Markov).
Verdict judge_held_out(const ReportData& data, const std::string& method) {
  constexpr double few = 0.5, less = 0.15;
  const Runs runs = data.runs_of(method);
  for (const EvaluatedRun* run : runs) {
    const Index count = run->evaluation.scores.held_out->num_compared;
    if (count < inference::kFewestForBounds) return too_few_samples(Check::held_out, count);
  }
  const auto [whose, of_uninformed] = uninformed(data);
  const auto [narrow, worse, least, worst] = held_out_of(runs, of_uninformed);
  const std::string bands =
      fmt::format("bands of {:.0f} % hold {:.0f} %", 100.0 * kJudgedBand, 100.0 * least);
  const std::string unseen = " of rollouts that inference hasn't seen";
  const std::string advice = advice_to_widen(data, method);
  const bool begins_with_noise = data.plan.study.method(method).refine.infer_first_states;
  if (narrow > 0 && !begins_with_noise) {
    return {Check::held_out, Judgment::fails,
            std::string(traits_of(Check::held_out).failure) + seeds_text(narrow, runs.size()) +
                ", " + bands,
            bands + unseen +
                ", and more of what any of its own samples predicts: it knows parameters or noise "
                "less well than it says: " +
                advice};
  }
  if (worse > 0) {
    return {Check::held_out, Judgment::fails,
            "predictions are WORSE than " + whose + seeds_text(worse, runs.size()) + ", " + bands,
            fmt::format("the CRPS of its predictions{} is {:.2g}, that of {} {:.2g}: {}", unseen,
                        worst, whose, of_uninformed, advice)};
  }
  if (narrow > 0) {
    return {Check::held_out, Judgment::unknown, "can't tell, " + bands,
            bands + unseen +
                ", but predictions begin in recorded first states, whose noise moves all of a "
                "rollout, some far more than others: a right posterior's bands may hold too few; "
                "the check of residuals tells more"};
  }
  if (least < few) {
    return {Check::held_out, Judgment::unknown, "can't tell, " + bands,
            bands + unseen +
                ", a right posterior's less than half with a probability of 0.2 at most; but some "
                "of its samples' own predictions are held as seldom: " +
                advice};
  }
  if (least < kJudgedBand - less) {
    return {Check::held_out, Judgment::passes, "passes, " + bands,
            bands + unseen +
                ", as those of some of its own samples' predictions do: chance, or it is a little "
                "too sure; more held-out rollouts tell, and " +
                advice};
  }
  return {Check::held_out, Judgment::passes, "passes, " + bands, ""};
}

}  // namespace npdr::pipeline
