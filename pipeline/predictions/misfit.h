/// What the best parameters leave of a recording, beside its noise (analysis/misfit.h).
#pragma once

#include <filesystem>
#include <optional>

#include "pipeline/artefacts/evaluation_file.h"
#include "pipeline/features/observation.h"
#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// Limits of Misfit::times, above which a simulator lacks something or the noise is another,
/// besides five deviations. Right simulators reach 1.03 where the noise is given and white, 1.6
/// where it is correlated (fits count errors as independent); 2.3 beside scatter that is smoothed
/// over 3 samples (docs/methods.md, check `fit`).
inline constexpr double kMostOfGivenNoise = 1.15;
inline constexpr double kMostOfCorrelatedNoise = 2.0;
inline constexpr double kMostOfScatter = 4.0;

/// Whether the study's simulator can begin in the middle of a rollout.
bool can_cut_rollouts(const Plan& plan);

/// Root mean square noise of recorded states, and whether the study gives it.
struct RecordedNoise {
  RowMatrix sigma;  ///< (H, C), at least a thousandth of the largest magnitude
  bool is_given = true;
};

/// What the study says of each channel, else what it scatters by (analysis/scatter.h).
RecordedNoise recorded_noise(const Observation& observation);

/// Fits `observation`, a recording, from `theta` (D) of the prior. Above the limits it is told what
/// change of the recording would explain the misfit, unless each call of the simulator starts a
/// program. `log`: where a program's output goes. None of a simulator that draws at random, of
/// noise of unknown scale that lasts or has heavy tails, which neighboring samples don't tell, and
/// where nothing can be simulated. Throws Checkpointed when a stop was requested.
std::optional<RecordingMisfit> find_misfit(const Plan& plan, const Observation& observation,
                                           const Vector& theta, const std::filesystem::path& log);

}  // namespace npdr::pipeline
