#include "pipeline/artefacts/prediction_scores.h"

namespace npdr::pipeline {
namespace {

void describe(Layout f, PredictionScores& scores) {
  const Dim channel{"C", "channel"}, level{"L", "level"};
  f("crps", scores.crps, {channel}, "of the stored states, over the largest recorded magnitude");
  f("coverage", scores.coverage, {level, channel},
    "share of them within central bands of 10, 20, ..., 90 and 95 %");
  f("noisy_crps", scores.noisy_crps, {channel}, "the same with observation noise, if there is any",
    {.unless_empty = true});
  f("noisy_coverage", scores.noisy_coverage, {level, channel}, "the same", {.unless_empty = true});
  f("log_score", scores.log_score, {channel},
    "log of the mean density of a state, over the largest recorded magnitude [nats], if all "
    "channels have noise",
    {.unless_empty = true});
  f.attribute("share_as_seldom_within", scores.share_as_seldom_within,
              "of the samples, whose own rollouts lie within the bands of 90 % as seldom as the "
              "recorded ones");
  f.attribute("num_compared", scores.num_compared, "samples, of which that is a share");
}

}  // namespace

void describe(Layout f, RolloutScores& scores) {
  if (auto seen = f.group("scores", scores.seen)) describe(*seen, *scores.seen);
  if (auto rest = f.group("held_out_scores", scores.held_out)) describe(*rest, *scores.held_out);
}

}  // namespace npdr::pipeline
