#include "pipeline/stages/power_search.h"

#include <algorithm>
#include <cmath>

namespace npdr::pipeline {
namespace {

constexpr double kAsGood = 0.01;  // of a score
constexpr double kFarther = 2.0;
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

double PowerSearch::best() const {
  const Vector means = scores_.crps.rowwise().mean();
  Index best = 0;
  const double least = means.minCoeff(&best);
  const auto deviations = scores_.crps.row(best).array() - least;
  const auto count = static_cast<double>(deviations.size());
  const double error = deviations.matrix().norm() / std::sqrt(count * (count - 1.0));
  const double bound = least + std::max(kAsGood * least, error);
  return scores_.power(std::ranges::find_if(means, [&](double m) { return m <= bound; }) -
                       means.begin());
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
