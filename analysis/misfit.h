/// What a simulator leaves of a recording, beside the recording's noise.
///
/// The size of errors (recording_fit.h) of H rollouts of K states of C channels is the mean over
/// rollouts and channels of sqrt(mean_k e^2), about 1 where a simulator is right. Draws of the
/// noise give its sampling error, whatever the noise's correlation and tails:
///   times = size left / mean size of draws,    deviation = that of draws / their mean.
/// A fit takes away a little of the noise, for which nothing is made up: a right simulator has
/// times = 1 at most.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/recording_fit.h"
#include "core/target.h"
#include "core/types.h"

namespace npdr::analysis {

/// Parts of equal length that rollouts are cut into, fewer where there are fewer states.
inline constexpr Index kMisfitParts = 10;

struct Misfit {
  Index num_rollouts = 0;  ///< H
  RowMatrix left;          ///< (H S, C) root mean square errors in each of S parts of a rollout
  RowMatrix of_noise;      ///< (H S, C) the same of draws of the noise, all together
  double times = 0.0;      ///< above
  double deviation = 0.0;  ///< above
};

/// Errors (H K, C), of the recording and of two draws or more. Throws ShapeError.
Misfit misfit(const RowMatrix& errors, const std::vector<RowMatrix>& draws, Index num_rollouts);

/// Where errors exceed the noise far more than elsewhere.
struct Concentration {
  Index begin = 0, end = 0;      ///< parts of rollouts; all of them: no part stands out
  std::optional<Index> channel;  ///< none: no channel stands out there
  std::optional<Index> rollout;  ///< the same
  double there = 0.0;            ///< root mean square of errors over those of noise
  double elsewhere = 0.0;
};

/// The fewest parts in a row, at most half of them, then the channel, then the rollout there, whose
/// errors over noise are three times the others' or more; none where all are alike.
std::optional<Concentration> concentration(const Misfit& misfit);

/// A change of a recording that would explain a misfit.
struct Cause {
  std::string fault;   ///< "rates were recorded 2 samples late"
  std::string change;  ///< "rates 2 samples earlier"
  double size = 0.0;   ///< of the errors that a fit leaves then, in units of the recording's
};

/// Of actions moved by up to 5 samples either way, rates (channels per second) likewise, time steps
/// longer or shorter by 2, 4, ..., 10 %, actions of the other sign, and actions or states times
/// 0.8, 0.9, 1.1 or 1.25, the change whose fit leaves the smallest errors. Of each of these five
/// kinds the best is fitted, by the errors that one Gauss-Newton step leaves in segments of a
/// sixteenth of a rollout; a later kind counts if it is better by 2 %. None where no fit can be
/// simulated.
std::optional<Cause> likeliest_cause(const FitProblem& problem, const Target& recording,
                                     const Vector& theta);

/// sqrt(mean_k e^2) of errors (H K, C) in the mean over rollouts and channels.
double size_of(const RowMatrix& errors, Index num_rollouts);

}  // namespace npdr::analysis
