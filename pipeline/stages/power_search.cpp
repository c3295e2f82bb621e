#include "pipeline/stages/power_search.h"

#include <algorithm>

namespace npdr::pipeline {
namespace {

constexpr double kFarther = 2.0;
constexpr Index kMorePowers = 3;
constexpr Index kPatience = 10;  // levels
constexpr double kRise = 1.2;

}  // namespace

void PowerSearch::add(double power, const LeftOutScore& score) {
  const Index k = scores_.power.size();
  const Index at = std::ranges::lower_bound(scores_.power, power) - scores_.power.begin();
  PowerScores more{Vector(k + 1), Vector(k + 1), RowMatrix(k + 1, score.crps.size())};
  for (Index i = 0; i < k; ++i) {
    const Index to = i < at ? i : i + 1;
    more.power(to) = scores_.power(i);
    more.noise_factor(to) = scores_.noise_factor(i);
    more.crps.row(to) = scores_.crps.row(i);
  }
  more.power(at) = power;
  more.noise_factor(at) = score.noise_factor;
  more.crps.row(at) = score.crps.transpose();
  scores_ = std::move(more);
}

double PowerSearch::best() const {
  const Vector means = scores_.crps.rowwise().mean();
  const double bound = scores_.as_good_as_any();
  return scores_.power(std::ranges::find_if(means, [&](double m) { return m <= bound; }) -
                       means.begin());
}

bool PowerSearch::is_over(double most) const {
  const Index k = scores_.power.size();
  if (k == 0) return false;
  const double highest = scores_.power(k - 1);
  const bool is_stuck = k > kPatience && highest < kRise * scores_.power(k - 1 - kPatience);
  const bool is_far = highest >= kFarther * scores_.power(scores_.least()) &&
                      k - 1 - scores_.least() >= kMorePowers;
  return is_stuck || is_far || highest >= most;
}

}  // namespace npdr::pipeline
