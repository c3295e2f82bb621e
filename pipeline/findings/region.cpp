// A posterior so narrow that hardly any simulations lie where it is.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "inference/diagnostics/share_of_prior.h"
#include "pipeline/findings/probe.h"

namespace npdr::pipeline {

std::string words_of_region(const MethodResults& m) {
  constexpr double most_simulations = 300.0;
  constexpr Index rounds = 4, fewest_simulations = 100;  // of one of them
  const inference::AlgorithmConfig& algorithm = m.method.algorithm;
  const bool can_go_on = m.study.source().simulates && algorithm.num_rounds == 1 &&
                         algorithm.num_simulations >= rounds * fewest_simulations &&
                         m.is(inference::Algorithm::npe_nle);
  if (!can_go_on) return "";
  const inference::Prior prior(m.study.prior);
  const double share = each(m.runs, [&](const EvaluatedRun* run) {
                         return inference::share_of_prior(prior.to_normal(run->evaluation.theta),
                                                          {1, "region", 0, 0, 0});
                       }).mean();
  const double expected = share * static_cast<double>(algorithm.num_simulations);
  const double largest_share = std::min(0.05, std::exp2(-static_cast<double>(prior.dimension())));
  if (share > largest_share || expected > most_simulations) return "";
  return fmt::format(
      "{} of {} simulations lie where it is: more of them there may make it more exact, by "
      "num_rounds = {} and num_simulations = {}, for this observation alone",
      expected < 1.0 ? "hardly any" : fmt::format("only about {:.0f}", expected),
      algorithm.num_simulations, rounds, (algorithm.num_simulations + rounds - 1) / rounds);
}

}  // namespace npdr::pipeline
