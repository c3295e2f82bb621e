#include "pipeline/artefacts/power_scores.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace npdr::pipeline {

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

}  // namespace npdr::pipeline
