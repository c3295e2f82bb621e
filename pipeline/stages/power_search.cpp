#include "pipeline/stages/power_search.h"

#include <algorithm>
#include <cmath>

namespace npdr::pipeline {
namespace {

constexpr double kAsGood = 0.01;  // of a score
constexpr double kFarther = 3.0;
constexpr Index kPatience = 10;  // levels
constexpr double kRise = 1.1;

}  // namespace

void PowerSearch::add(double power, const Vector& crps) {
  const Index k = scores_.power.size();
  const Index at = std::ranges::lower_bound(scores_.power, power) - scores_.power.begin();
  PowerScores more{Vector(k + 1), RowMatrix(k + 1, crps.size())};
  for (Index i = 0; i <= k; ++i) {
    const Index old = i < at ? i : i - 1;
    more.power(i) = i == at ? power : scores_.power(old);
    if (i == at) {
      more.crps.row(i) = crps.transpose();
    } else {
      more.crps.row(i) = scores_.crps.row(old);
    }
  }
  scores_ = std::move(more);
}

bool PowerSearch::is_about_as_good_as(Index best, Index k) const {
  const Vector worse = (scores_.crps.row(k) - scores_.crps.row(best)).transpose();
  const auto count = static_cast<double>(worse.size());
  const double deviation = (worse.array() - worse.mean()).matrix().norm() / std::sqrt(count - 1.0);
  return worse.mean() <=
         std::max(kAsGood * scores_.crps.row(best).mean(), deviation / std::sqrt(count));
}

double PowerSearch::best() const {
  Index best = 0;
  scores_.crps.rowwise().mean().minCoeff(&best);
  Index k = 0;
  while (!is_about_as_good_as(best, k)) ++k;
  return scores_.power(k);
}

bool PowerSearch::is_over(double most) const {
  const Index k = scores_.power.size();
  if (k == 0) return false;
  const double highest = scores_.power(k - 1);
  const bool is_stuck = k > kPatience && highest < kRise * scores_.power(k - 1 - kPatience);
  return is_stuck || highest >= kFarther * best() || highest >= most;
}

bool PowerSearch::ends_at_best(double most) const {
  const Index k = scores_.power.size();
  return k > 0 && scores_.power(k - 1) < most && scores_.power(k - 1) == best();
}

}  // namespace npdr::pipeline
