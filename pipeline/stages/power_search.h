/// Choice of the power of the likelihood, by how well left-out rollouts are predicted.
#pragma once

#include "pipeline/artefacts/power_scores.h"
#include "pipeline/predictions/left_out.h"

namespace npdr::pipeline {

class PowerSearch {
 public:
  explicit PowerSearch(PowerScores scores) : scores_(std::move(scores)) {}

  const PowerScores& scores() const { return scores_; }

  /// Adds the score of a power, which may be below earlier ones.
  void add(double power, const LeftOutScore& score);

  /// The smallest power that is about as good as any: larger ones cost more, and say more of
  /// parameters than predictions bear out. About as good: whose score, mean over rollouts, is worse
  /// than the best by at most the standard error of the latter (Breiman et al. 1984,
  /// "Classification and regression trees", 3.4.3), or a hundredth.
  double best() const;

  /// Whether there is nothing more to try: three larger powers than the one whose score is least
  /// have been, up to twice as large or more, or `most`, or ten levels have raised it by less than
  /// a fifth. Levels may raise the power tenfold, and the first ones know little of the posterior.
  bool is_over(double most) const;

 private:
  PowerScores scores_;
};

}  // namespace npdr::pipeline
